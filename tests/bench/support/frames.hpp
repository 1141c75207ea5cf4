// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
// Frames for benchmarks: read from flat dumps, or synthetic.
#include <cmath>
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

/// Colored tiles under a smooth light with a hard shadow; both move with `time`.
inline RgbaFrame synthetic_frame(Extent extent, int time) {
  RgbaFrame frame{extent, std::vector<float>(extent.pixels() * 4, 1.0F)};
  for (uint32_t y = 0; y < extent.height; ++y) {
    for (uint32_t x = 0; x < extent.width; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(extent.width);
      const float v = static_cast<float>(y) / static_cast<float>(extent.height);
      const auto tile = static_cast<unsigned>(u * 8) * 5U + static_cast<unsigned>(v * 6) * 11U;
      const float light = 0.45F + 0.3F * std::sin(5 * u + 2 * v + 0.1F * static_cast<float>(time));
      const float shadow = u + 0.7F * v > 1.0F + 0.01F * static_cast<float>(time) ? 0.35F : 1.0F;
      float* pixel = &frame.pixels[(static_cast<size_t>(y) * extent.width + x) * 4];
      for (unsigned c = 0; c < 3; ++c) {
        pixel[c] = light * shadow * (0.1F + 0.05F * static_cast<float>(tile * (2 * c + 3) % 17U));
      }
    }
  }
  return frame;
}

/// Reads frames that lie one after another: int32 width, int32 height, width × height RGBA floats.
/// Throws std::runtime_error where there are none or the file ends inside one.
inline std::vector<RgbaFrame> read_frames(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<RgbaFrame> frames;
  for (int32_t size[2]; file.read(reinterpret_cast<char*>(size), sizeof size);) {
    if (size[0] < 1 || size[1] < 1) throw std::runtime_error(path + " is not a dump of frames");
    RgbaFrame frame{{static_cast<uint32_t>(size[0]), static_cast<uint32_t>(size[1])}, {}};
    frame.pixels.resize(frame.extent.pixels() * 4);
    file.read(reinterpret_cast<char*>(frame.pixels.data()),
              static_cast<std::streamsize>(frame.pixels.size() * sizeof(float)));
    if (!file) throw std::runtime_error(path + " ends inside a frame");
    frames.push_back(std::move(frame));
  }
  if (frames.empty()) throw std::runtime_error("no frames in " + path);
  return frames;
}

}  // namespace inverse::bench
