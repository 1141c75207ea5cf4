// SPDX-License-Identifier: LGPL-2.1-or-later
#include "text_lines.hpp"

#include <charconv>
#include <cmath>

#include "common/error.hpp"
#include "common/open_file.hpp"

namespace inverse {
namespace {

Words words_of(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r";
  Words words;
  for (size_t at = 0; (at = line.find_first_not_of(kBlanks, at)) != line.npos;) {
    const size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

}  // namespace

std::optional<double> finite_number(std::string_view word) {
  double value = 0;
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return {};
  return value;
}

std::optional<double> time_number(std::string_view word) {
  constexpr double kLongest = 1e12;
  const auto time = finite_number(word);
  return time && std::abs(*time) < kLongest ? time : std::nullopt;
}

void read_lines(const std::string& path, const char* expected, std::vector<std::string>& warnings,
                const std::function<bool(const Words&)>& take) {
  constexpr uint64_t kMaxBytes = uint64_t{1} << 26;
  std::string fault;
  const std::string text = read_file(path, kMaxBytes, fault);
  if (!fault.empty()) throw Error(ErrorKind::file, path + ": it " + fault);
  size_t number = 0, wrong = 0, first_wrong = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    ++number;
    const Words words = words_of(line);
    if (words.empty() || words.front().starts_with('#') || take(words)) continue;
    if (wrong++ == 0) first_wrong = number;
  }
  if (wrong == 0) return;
  warnings.push_back(path + ": line " + std::to_string(first_wrong) +
                     (wrong > 1 ? " and " + std::to_string(wrong - 1) + " more are" : " is") +
                     " not \"" + expected + "\"; " + (wrong > 1 ? "they are" : "it is") +
                     " left out");
}

}  // namespace inverse
