// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
// Frames for benchmarks, read from flat dumps.
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "kernels/image/plane.hpp"

namespace inverse::bench {

/// width × height RGBA floats, linear light.
struct RgbaFrame {
  Extent extent;
  std::vector<float> pixels;
};

/// Reads a frame: int32 width, int32 height, width × height RGBA floats. Throws std::runtime_error
/// where there is none or the file ends inside it.
inline RgbaFrame read_frame(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  int32_t size[2];
  if (!file.read(reinterpret_cast<char*>(size), sizeof size) || size[0] < 1 || size[1] < 1)
    throw std::runtime_error(path + " is not a dump of a frame");
  RgbaFrame frame{{static_cast<uint32_t>(size[0]), static_cast<uint32_t>(size[1])}, {}};
  frame.pixels.resize(frame.extent.pixels() * 4);
  file.read(reinterpret_cast<char*>(frame.pixels.data()),
            static_cast<std::streamsize>(frame.pixels.size() * sizeof(float)));
  if (!file) throw std::runtime_error(path + " ends inside a frame");
  return frame;
}

}  // namespace inverse::bench
