// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace inverse {

/// Holds the time that frames take by choosing how much work goes into them: a level of
/// settings from cheap to good, each with what it costs in relation to the others.
///
/// Down: at once, by as many levels as needed, if the median time of the last frames is too long.
/// Up: one level, if the predicted time of the level above was within the budget for a while for
/// all but the slowest frames. A level that turned out too slow is tried again after twice the
/// time, which prevents oscillation. A single slow frame changes nothing. Uses neither clock nor
/// GStreamer: times come from the caller, in seconds that never go back. Not thread-safe.
class RateController {
 public:
  struct Goal {
    double fps = 0;         ///< frames a second to hold; 0: any
    double latency_ms = 0;  ///< the longest that a frame may take; 0: any time
    bool on() const { return fps > 0 || latency_ms > 0; }
    /// The time for one frame, the smaller of the two; infinite if neither is set.
    double budget_ms() const;
  };
  /// What it chose, and why.
  struct Report {
    size_t level = 0;         ///< 0 is the cheapest
    double predicted_ms = 0;  ///< what a frame is expected to take at this level; 0: not known yet
    double budget_ms = 0;
    uint64_t moves = 0;  ///< changes of level so far
    std::string reason;  ///< of the last one; empty if there was none
  };

  /// `costs` of the levels, positive and rising; only their ratios count.
  explicit RateController(std::span<const double> costs);

  /// What to hold from now on, and the best level that it may choose. Without a goal that is the
  /// level; a new goal starts there.
  void set_goal(const Goal& goal, size_t top);
  size_t level() const { return level_; }
  const Report& report() const { return report_; }

  /// A frame that ran at `level` took so long. Frames of other levels than the present one, which
  /// were still in flight when it changed, do not count.
  void frame(double now_s, double took_ms, size_t level);
  /// The sink reported (QoS) how late a frame came; negative: early.
  void late(double now_s, double by_ms);
  /// A stream starts: forgets what frames took so far.
  void forget();

  static constexpr double kRoom = 0.85;    ///< share of the budget that a level to go to may take
  static constexpr double kTrialWait = 2;  ///< s that a level above has room before it is tried
  static constexpr double kMaxTrialWait = 32;  ///< s, after it failed again and again
  static constexpr double kTrial = 10;         ///< s that a level has to hold to count as a success
  static constexpr double kEcho = 0.3;     ///< s after a change in which late reports are ignored
  static constexpr size_t kWindow = 5;     ///< frames that count
  static constexpr unsigned kStart = 3;    ///< first frames of a stream, which pay for its setup
  static constexpr size_t kMinFrames = 3;  ///< of them after a change

 private:
  double predicted(size_t level) const { return typical_ * costs_[level] / costs_[level_]; }
  void clear();
  void move(double now_s, size_t to, const std::string& reason);
  /// The value that `above` of the last frames, at most kWindow of them, took longer than.
  double took_but(size_t above) const;

  std::vector<double> costs_;
  Goal goal_;
  size_t level_, top_;
  std::array<double, kWindow> took_{};
  unsigned start_ = kStart;  // frames yet to be left out
  size_t frames_ = 0;        // at this level
  double typical_ = 0;
  unsigned late_ = 0;               // reports in a row
  std::vector<double> trial_wait_;  // s that each level has to have room before it is tried
  std::optional<double> moved_, climbed_, room_since_;  // s
  Report report_;
};

}  // namespace inverse
