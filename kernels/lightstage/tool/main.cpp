// SPDX-License-Identifier: LGPL-2.1-or-later
// inverse-light-program PROGRAM [--rate STEPS] [--overwrite] [FILE]: writes a light program as JSON
// (docs/reference/light-program.md), such as "static:96" at 30 or 30000/1001 steps a second.
#include <charconv>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "common/error.hpp"
#include "common/replace_file.hpp"
#include "kernels/lightstage/program/light_program.hpp"

namespace {

using namespace inverse;

constexpr const char* kUsage =
    "usage: inverse-light-program PROGRAM [--rate STEPS] [--overwrite] [FILE]\n"
    "  PROGRAM  performance or static, also with a number of lights as static:96; or a file\n"
    "  STEPS    a second: a number, or a fraction as 30000/1001; 60 where it is left out\n"
    "  FILE     to write; else it is printed. One that exists is replaced only with --overwrite\n";

uint32_t number(std::string_view text) {
  uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value == 0)
    throw Error(ErrorKind::unsupported, "\"" + std::string(text) + "\" is no number of steps");
  return value;
}

void set_rate(LightProgram& program, std::string_view rate) {
  const size_t slash = rate.find('/');
  program.rate_numerator = number(rate.substr(0, slash));
  program.rate_denominator = slash == rate.npos ? 1 : number(rate.substr(slash + 1));
  program.check();
}

int run(const std::vector<std::string>& words) {
  std::vector<std::string> names;
  std::string rate;
  bool understood = true, help = false, overwrite = false;
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--rate" && i + 1 < words.size())
      rate = words[++i];
    else if (words[i] == "--overwrite")
      overwrite = true;
    else if (words[i] == "--help" || words[i] == "-h")
      help = true;
    else if (words[i].starts_with("-"))
      understood = false;
    else
      names.push_back(words[i]);
  }
  if (help) {
    std::fputs(kUsage, stdout);
    return 0;
  }
  if (!understood || names.empty() || names.size() > 2) {
    std::fputs(kUsage, stderr);
    return 2;
  }
  LightProgram program = light_program(names[0]);
  if (!rate.empty()) set_rate(program, rate);
  if (names.size() == 2)
    write_file(names[1], program.json(), overwrite);
  else
    std::puts(program.json().c_str());
  return 0;
}

}  // namespace

int main(int count, char** arguments) try {
  return run({arguments + 1, arguments + count});
} catch (const std::exception& error) {
  std::fprintf(stderr, "inverse-light-program: %s\n", error.what());
  return 1;
}
