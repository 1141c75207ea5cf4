#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>

namespace inverse {

/// From a camera's timestamps to the pipeline's running time.
///
/// The first frame is taken to have come at once. From then on the camera's clock runs freely but
/// for a slow correction: frames can come late, never early, so that the least delay of a second
/// says how far the two clocks have drifted apart. What comes out is as even as the camera's
/// own stamps and never runs backwards, however late single frames come.
class CameraClock {
 public:
  /// The longest that a correction waits, and what it looks back on.
  static constexpr int64_t kWindow = 1'000'000'000;
  /// Corrections change the rate of time by a thousandth at most; crystals differ by a tenth of it.
  static constexpr double kSlew = 1e-3;
  /// A frame that is so early, or a second of frames so late, and the camera's clock has jumped.
  static constexpr int64_t kJump = 250'000'000;
  /// Without frames for so long, and the next one is like the first.
  static constexpr uint64_t kGap = 5'000'000'000;

  /// The running time of a frame that the camera stamped `camera` and that began to arrive at
  /// `arrival`, a running time, too. All in ns.
  int64_t map(uint64_t camera, int64_t arrival) {
    if (!anchored_ || camera <= last_) return anchor(camera, arrival);
    // How far the clocks drift apart in such a time is not known.
    if (camera - last_ > kGap) return anchor(camera, arrival);
    offset_ += rate_ * static_cast<double>(camera - last_);
    last_ = camera;
    const int64_t time = anchor_arrival_ + static_cast<int64_t>(camera - anchor_camera_) +
                         static_cast<int64_t>(offset_);
    const int64_t delay = arrival - time;
    if (delay < -kJump) return anchor(camera, arrival);
    least_delay_ = std::min(least_delay_, delay);
    ++frames_;
    if (static_cast<int64_t>(camera - window_start_) >= kWindow && frames_ >= 4) {
      if (least_delay_ > kJump) return anchor(camera, arrival);
      rate_ = std::clamp(static_cast<double>(least_delay_) / kWindow, -kSlew, kSlew);
      start_window(camera);
    }
    return newest_ = std::max(time, newest_ + 1);
  }
  /// Forgets all: the next frame is the first.
  void reset() { *this = CameraClock(); }

  /// How often the camera's clock jumped.
  uint64_t jumps() const { return jumps_; }
  /// How much is added to the camera's time at present, parts per million.
  double correction_ppm() const { return rate_ * 1e6; }

 private:
  int64_t anchor(uint64_t camera, int64_t arrival) {
    if (anchored_ && (camera <= last_ || camera - last_ <= kGap)) ++jumps_;
    // Time does not run backwards where the camera's does.
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
    least_delay_ = std::numeric_limits<int64_t>::max();
    frames_ = 0;
  }

  bool anchored_ = false;
  uint64_t anchor_camera_ = 0, last_ = 0, window_start_ = 0;
  int64_t anchor_arrival_ = 0, newest_ = std::numeric_limits<int64_t>::min();
  int64_t least_delay_ = 0;
  double offset_ = 0, rate_ = 0;  ///< offset_: what was corrected since the anchor, ns
  uint32_t frames_ = 0;
  uint64_t jumps_ = 0;
};

}  // namespace inverse
