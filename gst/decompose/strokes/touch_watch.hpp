// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "kernels/camera/touch.hpp"

namespace inverse {

/// Makes touches, from their first frame to their last, out of what single frames show.
class TouchWatch {
 public:
  enum class Event : uint8_t { none, began, moved, ended };

  /// What a completed frame touches. One that is far from the touch before is another.
  Event see(std::optional<Touch> touch) {
    constexpr unsigned kToBegin = 2, kToEnd = 3;  // frames in a row
    const bool other = touch && (on_ || near_ > 0) && !reaches(touch->place);
    if (on_ && other) touch.reset();
    if (touch) last_ = touch->place;
    near_ = !touch ? 0 : other ? 1 : near_ + 1;
    away_ = touch ? 0 : away_ + 1;
    if (!on_ && near_ >= kToBegin) return on_ = true, Event::began;
    if (on_ && away_ >= kToEnd) return on_ = false, Event::ended;
    return on_ && touch ? Event::moved : Event::none;
  }
  bool on() const { return on_; }
  void forget() { *this = {}; }

 private:
  /// Whether a hand may have come there since the frame before.
  bool reaches(const std::array<float, 3>& place) const {
    constexpr float kFar = 0.12F;  // meters
    return std::hypot(place[0] - last_[0], place[1] - last_[1], place[2] - last_[2]) < kFar;
  }

  std::array<float, 3> last_{};  // where it touched
  unsigned near_ = 0, away_ = 0;
  bool on_ = false;
};

}  // namespace inverse
