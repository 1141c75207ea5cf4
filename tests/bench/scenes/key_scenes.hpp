// SPDX-License-Identifier: LGPL-2.1-or-later
// Foregrounds before a screen of one paint, with truth: a body with textured cloth, hair from 0.3
// to 3 pixels wide, and things that move 4 to 40 pixels in a frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tests/bench/metrics/image.hpp"

namespace inverse::bench {

struct KeyFrame {
  std::vector<uint8_t> seen;  ///< RGBA, sRGB: what a camera with noise sends
  Image alpha;                ///< one channel
  Image front;                ///< light of the foreground times alpha, linear, without spill
};

struct KeyScene {
  int width = 384, height = 216, frames = 3;
  bool blue = false;  ///< else a green screen
  unsigned seed = 1;

  /// sRGB codes of the screen's paint under mean light.
  std::array<int, 3> screen_code() const;
  /// Averages 16 moments of the time that the shutter is open, each of 4 x 4 samples a pixel.
  KeyFrame frame(int number) const;
  /// Light of another background, three channels, linear.
  Image background() const;
};

}  // namespace inverse::bench
