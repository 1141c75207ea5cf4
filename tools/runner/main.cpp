// SPDX-License-Identifier: LGPL-2.1-or-later
// inverse-run: plays a file, URI or camera through a piece of a launch line. ./dev run and the
// bundle call it.
#include <gst/gst.h>
#include <gst/pbutils/pbutils.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "runner.hpp"

namespace {

constexpr const char* kUsage =
    "inverse-run --clip FILE [--window | --file] [--seconds S] [--out FOLDER] [--overwrite] "
    "[FILE|URI|/dev/videoN] [-- ELEMENTS]\n"
    "  shows input, reflectance, shading and the input with one color repainted\n"
    "  ELEMENTS    instead of these: a piece of a gst-launch-1.0 line, raw video in and out\n"
    "  --clip      the bundled clip, played if no other input is named\n"
    "  --window    show a window or fail; --file: write files even where there is a display\n"
    "  --seconds   stop after that much video\n"
    "  --out       where to write decomposition.mkv and contact-sheet.png (out)\n"
    "  --overwrite replace those that are there\n";

// In the bundled clip, red is painted blue. In other input, Paint finds a color that stands out.
constexpr const char* kClipColors = "key=0xffe01e32 target=0xff2878f0 tolerance=0.5";
constexpr const char* kNoColors = "strength=0";

/// One decomposition, four views.
std::string four_views(const char* colors) {
  std::string line =
      "intrinsicdecomp ! tee name=layers "
      "layers. ! queue ! intrinsiccompose name=input show=input ! mosaic.sink_0 "
      "layers. ! queue ! intrinsiccompose name=reflectance show=reflectance ! mosaic.sink_1 "
      "layers. ! queue ! intrinsiccompose name=shading show=shading ! mosaic.sink_2 "
      "layers. ! queue ! intrinsicrecolor name=recolor ";
  line.append(colors).append(" ! intrinsiccompose name=recolored ! mosaic.sink_3 ");
  line.append("compositor name=mosaic background=black");
  for (int i = 0; i < 4; ++i) {
    char pad[160];
    snprintf(pad, sizeof pad,
             " sink_%d::xpos=%d sink_%d::ypos=%d sink_%d::width=640 sink_%d::height=480 "
             "sink_%d::sizing-policy=keep-aspect-ratio",
             i, i % 2 * 640, i, i / 2 * 480, i, i, i);
    line += pad;
  }
  return line;
}

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
  std::string input, clip;
  int i = 1;
  const auto value = [&] {
    if (i + 1 >= count) throw std::runtime_error(std::string(words[i]) + " needs a value");
    return std::string(words[++i]);
  };
  for (; i < count && strcmp(words[i], "--") != 0; ++i) {
    const std::string word = words[i];
    if (word == "--help" || word == "-h") {
      fputs(kUsage, stdout);
      exit(0);
    } else if (word == "--window") {
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
    } else if (word == "--overwrite") {
      options.overwrite = true;
    } else if (word == "--clip") {
      clip = value();
    } else if (word.size() > 1 && word[0] == '-') {
      throw std::runtime_error("unknown option " + word + "\n" + kUsage);
    } else if (!input.empty()) {
      throw std::runtime_error("one input at a time: " + input + " or " + word +
                               "; elements come after --");
    } else {
      input = word;
    }
  }
  const bool plays_clip = input.empty();
  if (plays_clip && clip.empty()) throw std::runtime_error(std::string("no input\n") + kUsage);
  options.input = inverse::run::parse_input(plays_clip ? clip : input);
  if (i + 1 < count) {
    options.chain = join(words + i + 1, count - i - 1);
  } else {
    options.chain = four_views(plays_clip ? kClipColors : kNoColors);
    if (!plays_clip) options.paint = "recolor";
  }
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
