// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cmath>

#include "tests/elements/element_test.hpp"
#include "tests/material/kernels/lime_models.hpp"

namespace inverse::testing {

inline constexpr int kWidth = 96, kHeight = 64;

/// Gray, with a disc that the networks take for an object; none if the radius is 0.
inline std::vector<uint8_t> scene(int x, int y, int radius, int width = kWidth,
                                  int height = kHeight) {
  std::vector<uint8_t> bytes(static_cast<size_t>(width) * height * 4, 128);
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column)
      if (std::hypot(column - x, row - y) < radius) {
        uint8_t* pixel = &bytes[4 * (static_cast<size_t>(row) * width + column)];
        pixel[0] = 230;
        pixel[1] = pixel[2] = 100;
      }
  return bytes;
}

/// limematerial with networks whose results are known.
class LimeElementTest : public ::testing::Test {
 protected:
  std::string line(const std::string& more = "") const {
    return "limematerial name=lime models=" + files.folder() + " " + more;
  }
  static std::string caps(int width = kWidth, int height = kHeight) {
    return VideoHarness::caps("RGBA", width, height);
  }
  /// What a pattern of two frames gives.
  LineResult run(const std::string& more) const {
    return run_line("videotestsrc num-buffers=2 ! " + line(more) + " ! fakesink");
  }
  HandMadeLime files;
};

}  // namespace inverse::testing
