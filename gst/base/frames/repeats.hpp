// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
namespace inverse {

/// How lately there were frames that show the very picture of the frame before: paused players,
/// slides, screens on which nothing happens, video whose rate was raised by sending frames twice.
class Repeats {
 public:
  /// Takes note of the next frame, and whether it repeats the one before.
  void next(bool repeated) { since_ = repeated ? 0 : since_ + (since_ < kMemory); }
  /// Whether one of the last `kMemory` frames was a repeat: whoever holds on to a frame's planes,
  /// so that editors cannot work in place, does so only while it is likely to be of use.
  bool going_on() const { return since_ < kMemory; }
  /// The next frame has no frame before.
  void reset() { *this = {}; }
  static constexpr unsigned kMemory = 16;

 private:
  unsigned since_ = kMemory;  // frames since the last repeat
};

}  // namespace inverse
