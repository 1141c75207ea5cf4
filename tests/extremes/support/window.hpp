// SPDX-License-Identifier: LGPL-2.1-or-later
// A window of bad input in an otherwise unchanged image.
#pragma once
#include <algorithm>

#include "inputs.hpp"

namespace inverse::extremes {

/// The case on a frame of `more` pixels more on each side, so that it has tiles enough; needles (up
/// to 3 pixels wide) stay needles, three times as long.
inline Case enlarged(Case one, uint32_t more) {
  for (uint32_t* side : {&one.width, &one.height})
    if (*side > 3) *side += more;
  if (one.width <= 3) one.height *= 3;
  if (one.height <= 3) one.width *= 3;
  return one;
}

/// The first frame of a case without what is bad in it.
inline Pixels clean_picture(Case one) {
  one.faults = 0;
  return frame_of(one, 0);
}

/// Where it begins; it ends after kSide pixels, or with the frame.
struct Window {
  static constexpr uint32_t kSide = 12;
  uint32_t left, top;
};

/// Copies what lies in the window from one frame to another.
inline void paste(Extent extent, const Pixels& from, Window window, Pixels* to) {
  const uint32_t right = std::min(window.left + Window::kSide, extent.width),
                 bottom = std::min(window.top + Window::kSide, extent.height);
  for (uint32_t y = window.top; y < bottom; ++y)
    for (uint32_t x = window.left; x < right; ++x) {
      const size_t i = 4 * (size_t{y} * extent.width + x);
      std::copy_n(&from[i], 4, &(*to)[i]);
    }
}

/// A video of a picture in whose window, from frame `first` on, four frames of six have the bad
/// input of a case; frame `whole` has it everywhere.
struct SpoiltVideo {
  const Case& one;
  const Pixels& picture;
  Window window;
  uint32_t first, whole;

  bool bad(uint32_t k) const { return k >= first && k % 6 < 4; }
  Pixels frame(uint32_t k) const {
    if (!bad(k)) return picture;
    Pixels spoilt = frame_of(one, k);
    if (k == whole) return spoilt;
    Pixels frame = picture;
    paste({one.width, one.height}, spoilt, window, &frame);
    return frame;
  }
};

}  // namespace inverse::extremes
