// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <optional>
#include <utility>

#include "kernels/volume/touch/touch_finder.hpp"

namespace inverse {

/// Makes touches, from their first frame to their last, out of what single frames show.
class TouchWatch {
 public:
  enum class Event : uint8_t { none, began, moved, ended };

  /// What a completed frame touches.
  Event see(const std::optional<Touch>& touch) {
    constexpr unsigned kToBegin = 2, kToEnd = 3;  // frames in a row
    near_ = touch ? near_ + 1 : 0;
    away_ = touch ? 0 : away_ + 1;
    if (!on_ && near_ >= kToBegin) return on_ = true, Event::began;
    if (on_ && away_ >= kToEnd) return on_ = false, Event::ended;
    return on_ && touch ? Event::moved : Event::none;
  }
  bool on() const { return on_; }
  void forget() { *this = {}; }

 private:
  unsigned near_ = 0, away_ = 0;
  bool on_ = false;
};

}  // namespace inverse
