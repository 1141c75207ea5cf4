// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>

namespace inverse {

/// Converts a camera's time stamps to the pipeline's running time.
///
/// The first frame is assumed to arrive without delay. Frames can be late, never early, so the
/// minimum delay within a second measures the drift between the clocks; a slow correction removes
/// it. The result is as regular as the camera's stamps and strictly increases, however late single
/// frames arrive.
class CameraClock {
 public:
  /// Period over which the drift is measured, ns.
  static constexpr int64_t kWindow = 1'000'000'000;
  /// Maximum relative correction of the rate; crystals differ by a tenth of it.
  static constexpr double kSlew = 1e-3;
  /// The camera's clock has jumped if a frame is this early, or all frames of a window this late,
  /// ns.
  static constexpr int64_t kJump = 250'000'000;
  /// After a gap of this length the next frame counts as the first, ns.
  static constexpr uint64_t kGap = 5'000'000'000;

  /// The running time of a frame with time stamp `camera` that began to arrive at running time
  /// `arrival`. All in ns.
  int64_t map(uint64_t camera, int64_t arrival) {
    if (!anchored_ || camera <= last_) return anchor(camera, arrival);
    // The drift over such a gap is unknown.
    if (camera - last_ > kGap) return anchor(camera, arrival);
    offset_ += rate_ * static_cast<double>(camera - last_);
    last_ = camera;
    const int64_t time = anchor_arrival_ + static_cast<int64_t>(camera - anchor_camera_) +
                         static_cast<int64_t>(offset_);
    const int64_t delay = arrival - time;
    if (delay < -kJump) return anchor(camera, arrival);
    min_delay_ = std::min(min_delay_, delay);
    ++frames_;
    if (static_cast<int64_t>(camera - window_start_) >= kWindow && frames_ >= 4) {
      if (min_delay_ > kJump) return anchor(camera, arrival);
      rate_ = std::clamp(static_cast<double>(min_delay_) / kWindow, -kSlew, kSlew);
      start_window(camera);
    }
    return newest_ = std::max(time, newest_ + 1);
  }
  /// Discards all state: the next frame counts as the first.
  void reset() { *this = CameraClock(); }

  /// Number of jumps of the camera's clock.
  uint64_t jumps() const { return jumps_; }
  /// Present correction of the camera's rate, parts per million.
  double correction_ppm() const { return rate_ * 1e6; }

 private:
  int64_t anchor(uint64_t camera, int64_t arrival) {
    if (anchored_ && (camera <= last_ || camera - last_ <= kGap)) ++jumps_;
    // Running time increases even if the camera's time runs backwards.
    if (anchored_) arrival = std::max(arrival, newest_ + 1);
    anchored_ = true;
    newest_ = arrival;
    anchor_camera_ = last_ = camera;
    anchor_arrival_ = arrival;
    offset_ = rate_ = 0;
    start_window(camera);
    return arrival;
  }
  void start_window(uint64_t camera) {
    window_start_ = camera;
    min_delay_ = std::numeric_limits<int64_t>::max();
    frames_ = 0;
  }

  bool anchored_ = false;
  uint64_t anchor_camera_ = 0, last_ = 0, window_start_ = 0;
  int64_t anchor_arrival_ = 0, newest_ = std::numeric_limits<int64_t>::min();
  int64_t min_delay_ = 0;
  double offset_ = 0, rate_ = 0;  ///< offset_: total correction since the anchor, ns
  uint32_t frames_ = 0;
  uint64_t jumps_ = 0;
};

}  // namespace inverse
