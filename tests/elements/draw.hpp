// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace inverse::testing {

/// An opaque frame of RGBA whose channels are `value(x, y, channel)`.
template <typename Value>
std::vector<uint8_t> draw(int width, int height, Value value) {
  std::vector<uint8_t> frame;
  frame.reserve(static_cast<size_t>(width) * static_cast<size_t>(height) * 4);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) frame.push_back(static_cast<uint8_t>(value(x, y, c)));
      frame.push_back(255);
    }
  return frame;
}

}  // namespace inverse::testing
