// SPDX-License-Identifier: LGPL-2.1-or-later
// Writes procedural scenes as files (scene_files.hpp), for fits in other languages.
//
//   write_scenes --out DIR [--first 1] [--scenes 100] [--width 160] [--height 120]
#include <cstdio>
#include <exception>
#include <string>

#include "scene_files.hpp"
#include "tests/bench/support/command_line.hpp"

int main(int argc, char** argv) {
  namespace bench = inverse::bench;
  namespace training = inverse::training;
  std::string out = ".";
  int first = 1, scenes = 100, width = 160, height = 120;
  const bench::Options known{{"--out", bench::text(out)},
                             {"--first", bench::integer(first)},
                             {"--scenes", bench::integer(scenes)},
                             {"--width", bench::integer(width)},
                             {"--height", bench::integer(height)}};
  if (!bench::read(known, argc, argv, "write_scenes.cpp")) return 2;
  try {
    for (int k = first; k < first + scenes; ++k)
      training::save_scene(training::make_scene(std::uint32_t(k), width, height),
                           out + "/" + std::to_string(k) + ".scene");
  } catch (const std::exception& e) {
    std::fprintf(stderr, "write_scenes: %s\n", e.what());
    return 1;
  }
  return 0;
}
