// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
namespace inverse {

/// Whether frames recently repeated their predecessor: paused players, slides, idle screens, video
/// whose rate was raised by repeating frames.
class Repeats {
 public:
  /// Counts the next frame.
  void next(bool repeated) { since_ = repeated ? 0 : since_ + (since_ < kMemory); }
  /// Whether one of the last `kMemory` frames was a repeat. Only then keep a frame's planes for the
  /// next: elements downstream cannot change kept planes in place.
  bool going_on() const { return since_ < kMemory; }
  /// The next frame has no frame before.
  void reset() { *this = {}; }
  static constexpr unsigned kMemory = 16;

 private:
  unsigned since_ = kMemory;  // frames since the last repeat
};

}  // namespace inverse
