// SPDX-License-Identifier: LGPL-2.1-or-later
// inverse-run: plays a file, URI or camera through a piece of a launch line. ./dev run calls it.
#include <gst/gst.h>
#include <gst/pbutils/pbutils.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "runner.hpp"

namespace {

constexpr const char* kUsage =
    "inverse-run [--window | --file] [--seconds S] [--out FOLDER] [--paint NAME] "
    "FILE|URI|/dev/videoN -- ELEMENTS\n"
    "  ELEMENTS    a piece of a gst-launch-1.0 line: takes raw video and gives raw video\n"
    "  --window    show a window or fail; --file: write files even where there is a display\n"
    "  --seconds   stop after that much video\n"
    "  --out       where to write decomposition.mkv and contact-sheet.png (out)\n"
    "  --paint     lets the intrinsicrecolor of that name repaint a color that stands out\n";

/// Joins the words after --. A single word is a line quoted as a whole; of several, each word keeps
/// its spaces, as in gst-launch-1.0.
std::string join(char** words, int count) {
  if (count == 1) return words[0];
  std::string line;
  for (int i = 0; i < count; ++i) {
    if (i > 0) line += ' ';
    for (const char* c = words[i]; *c; ++c) {
      if (*c == ' ') line += '\\';
      line += *c;
    }
  }
  return line;
}

inverse::run::Options parse(int count, char** words) {
  using inverse::run::View;
  inverse::run::Options options;
  std::string input;
  int i = 1;
  const auto value = [&] {
    if (i + 1 >= count) throw std::runtime_error(std::string(words[i]) + " needs a value");
    return std::string(words[++i]);
  };
  for (; i < count && strcmp(words[i], "--") != 0; ++i) {
    const std::string word = words[i];
    if (word == "--window") {
      options.view = View::window;
    } else if (word == "--file") {
      options.view = View::file;
    } else if (word == "--seconds") {
      const std::string text = value();
      char* end = nullptr;
      options.seconds = strtod(text.c_str(), &end);
      if (*end || !(options.seconds > 0))
        throw std::runtime_error("--seconds takes a number above 0, not \"" + text + "\"");
    } else if (word == "--out") {
      options.folder = value();
    } else if (word == "--paint") {
      options.paint = value();
    } else if (word.size() > 1 && word[0] == '-') {
      throw std::runtime_error("unknown option " + word + "\n" + kUsage);
    } else if (!input.empty()) {
      throw std::runtime_error("one input at a time: " + input + " or " + word +
                               "; elements come after --");
    } else {
      input = word;
    }
  }
  if (input.empty()) throw std::runtime_error(std::string("no input\n") + kUsage);
  if (i + 1 >= count) throw std::runtime_error("no elements after --\n" + std::string(kUsage));
  options.input = inverse::run::parse_input(input);
  options.chain = join(words + i + 1, count - i - 1);
  return options;
}

}  // namespace

int main(int count, char** words) {
  gst_init(nullptr, nullptr);
  gst_pb_utils_init();
  try {
    inverse::run::run(parse(count, words));
  } catch (const std::exception& error) {
    fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
