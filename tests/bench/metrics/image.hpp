// SPDX-License-Identifier: LGPL-2.1-or-later
// A float image: interleaved channels, rows top to bottom, no padding.
#pragma once

#include <cstddef>
#include <vector>

namespace inverse::bench {

/// width x height pixels of `channels` interleaved floats; linear light unless stated otherwise.
struct Image {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<float> data;

  Image() = default;
  Image(int w, int h, int c, float value = 0.0F)
      : width(w), height(h), channels(c), data(std::size_t(w) * h * c, value) {}

  float& at(int x, int y, int c = 0) {
    return data[(std::size_t(y) * width + x) * std::size_t(channels) + std::size_t(c)];
  }
  float at(int x, int y, int c = 0) const {
    return data[(std::size_t(y) * width + x) * std::size_t(channels) + std::size_t(c)];
  }
  bool empty() const { return data.empty(); }
};

}  // namespace inverse::bench
