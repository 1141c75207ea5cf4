// SPDX-License-Identifier: LGPL-2.1-or-later
// Small recordings of a camera with depth, and what elements make of them.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "gst/inverse/inverse_depth_meta.h"
#include "tests/elements/element_test.hpp"
#include "tests/kernels/environment/normal_map_file.hpp"

namespace inverse::testing {

/// A picture with what came with it.
struct RgbdBuffer {
  GstClockTime time = 0, duration = 0;
  guint64 offset = 0;
  bool has_depth = false;
  GstInverseDepthMeta meta{};  // without its image
  std::vector<uint16_t> steps;
};

inline RgbdBuffer rgbd_buffer(GstBuffer* buffer) {
  RgbdBuffer seen{.time = GST_BUFFER_PTS(buffer),
                  .duration = GST_BUFFER_DURATION(buffer),
                  .offset = GST_BUFFER_OFFSET(buffer)};
  if (const GstInverseDepthMeta* meta = gst_buffer_get_inverse_depth_meta(buffer)) {
    seen.has_depth = true;
    seen.meta = *meta;
    seen.steps.resize(size_t{meta->width} * meta->height);
    gst_buffer_extract(meta->depth, 0, seen.steps.data(), 2 * seen.steps.size());
  }
  return seen;
}

inline void write_file(const TemporaryFolder& folder, const std::string& name,
                       const std::vector<uint8_t>& bytes) {
  std::filesystem::create_directories(std::filesystem::path(folder / name).parent_path());
  folder.write(name, std::as_bytes(std::span(bytes)));
}

/// A PNG with the pixels (red, x, y).
inline void write_color(const TemporaryFolder& folder, const std::string& name, uint8_t red,
                        uint32_t width = 64, uint32_t height = 48) {
  std::vector<uint8_t> bytes;
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x)
      bytes.insert(bytes.end(), {red, static_cast<uint8_t>(x), static_cast<uint8_t>(y)});
  write_file(folder, name, png(width, height, 3, 8, bytes));
}

inline void write_depth(const TemporaryFolder& folder, const std::string& name,
                        const std::vector<uint16_t>& steps, uint32_t width, uint32_t height) {
  std::vector<uint8_t> bytes;
  for (const uint16_t step : steps)
    bytes.insert(bytes.end(), {static_cast<uint8_t>(step >> 8), static_cast<uint8_t>(step)});
  write_file(folder, name, png(width, height, 1, 16, bytes));
}

/// `first` + 1, + 2 …, row by row, but 0 and 65535 at the first two pixels.
inline void write_depth(const TemporaryFolder& folder, const std::string& name, uint16_t first,
                        uint32_t width = 64, uint32_t height = 48) {
  std::vector<uint16_t> steps{0, 65535};
  while (steps.size() < size_t{width} * height)
    steps.push_back(static_cast<uint16_t>(first + steps.size()));
  write_depth(folder, name, steps, width, height);
}

}  // namespace inverse::testing
