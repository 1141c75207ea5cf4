// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

namespace inverse {

/// Finds the trigger of each frame of one camera, counted from its first frame, from time stamps
/// and, if present, frame ids.
///
/// A time stamp is the trigger's time plus an unknown constant offset and a jitter of at most
/// ±`Params::jitter`, on a clock whose rate error is at most `Params::drift`. A hypothesis is an
/// assignment of triggers to frames within these bounds, with an interval for the time of the last
/// trigger; frames narrow the interval, time widens it. A frame is reported once all hypotheses
/// agree on its trigger, so that the trigger is correct if the bounds hold. Until then the frame
/// waits, at most for `Params::hold` further frames.
class TriggerCounter {
 public:
  struct Params {
    double jitter = 0.34;  ///< periods, less than a half
    double drift = 250;    ///< ppm
    uint32_t id_bits = 0;  ///< frame ids count modulo 2^16, 2^32 or 2^64; 0: no ids
    uint32_t hold = 24;    ///< frames
  };
  struct Frame {
    uint64_t token = 0;          ///< chosen by the caller
    std::optional<double> time;  ///< periods, from any origin
    std::optional<uint64_t> id;
    uint64_t content = 0;  ///< hash of its pixels; 0: unknown
  };
  struct Counted {
    enum class Fate : uint8_t {
      trigger,       ///< `trigger` is certain
      contradicted,  ///< `trigger` fits the times, but the image contradicts it
      off,           ///< too far from the time of any trigger, or without a time
      ambiguous,     ///< hypotheses did not agree in time
    };
    uint64_t token = 0;
    Fate fate = Fate::off;
    int64_t trigger = 0;
    bool late = false;      ///< of `off`: later than any possible trigger time
    bool conflict = false;  ///< of `off`: same time as the frame before, but other pixels
  };
  /// Whether the image cannot be of this trigger. Called within `push`.
  using Contradicts = std::function<bool(int64_t trigger, const Frame& frame)>;

  explicit TriggerCounter(const Params& params) : params_(params) { restart(); }

  /// Adds the next frame in order of arrival. Returns the frames that it decides, in order of
  /// arrival, except that frames that are `off` are returned at once.
  std::vector<Counted> push(const Frame& frame, const Contradicts& contradicts);
  /// Ends the stream: returns all waiting frames.
  std::vector<Counted> drain();
  /// Discards waiting frames. The next frame may have any time, also an earlier one; the count goes
  /// on from it.
  void flush();
  /// Starts a new count at the next frame.
  void restart();
  /// Changes with every restart, including automatic ones after too many frames that do not fit.
  /// Triggers of different epochs are not comparable.
  uint64_t epoch() const { return epoch_; }
  /// Bounds of the duration of a trigger, periods by the clock of the time stamps.
  double slowest() const { return slow_; }
  double fastest() const { return fast_; }

 private:
  struct Hypothesis {
    double low = 0, high = 0;      ///< time of `trigger`
    int64_t trigger = 0;           ///< of the latest frame
    uint64_t id = 0, content = 0;  ///< of that frame
    std::deque<int64_t> held;      ///< triggers of the frames in `held_`
    bool by_id = false;            ///< `id` is known
    bool operator==(const Hypothesis& other) const {
      return trigger == other.trigger && held == other.held;
    }
  };
  struct Held {
    uint64_t token;
    bool contradicted;
  };
  std::vector<Hypothesis> fitting(const Hypothesis& before, const Frame& frame, bool use_id) const;
  void add_if_fitting(const Hypothesis& before, const Frame& frame, int64_t step,
                      std::vector<Hypothesis>& to) const;
  void resolve(std::vector<Counted>& out);
  void give_up(std::vector<Counted>& out);
  void measure_rate();

  Params params_;
  std::vector<Hypothesis> hypotheses_;
  std::deque<Held> held_;
  uint64_t epoch_ = 0;
  uint32_t off_in_row_ = 0, ambiguous_in_row_ = 0;
  double slow_ = 1, fast_ = 1;  // bounds of a trigger's duration, periods
  struct {
    int64_t trigger;
    double low, high;
  } checkpoint_{};
  bool any_time_ = false;            // after a flush
  bool skips_zero_possible_ = true;  // ids that wrap from the largest to 1
};

}  // namespace inverse
