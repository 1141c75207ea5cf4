#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

namespace inverse {

/// Which trigger of the cameras each frame of one camera belongs to, counted from its first frame,
/// by its time stamp and, where there are some, by the camera's frame ids.
///
/// Time stamps are trigger times plus an offset that nobody knows and a jitter of at most
/// `Params::jitter` either way, on a clock that runs at most `Params::drift` too fast or too slow.
/// All that fits these bounds is an explanation: a trigger for each frame, and the interval in
/// which the last trigger's time (jitter apart) lies, which every frame narrows and time widens. A
/// frame's trigger is told once all explanations agree on it, so that within the bounds it cannot
/// be wrong; until then the frame is held, at most for `Params::hold` further frames.
class TriggerCounter {
 public:
  struct Params {
    double jitter = 0.34;  ///< periods, less than a half
    double drift = 250;    ///< ppm
    uint32_t id_bits = 0;  ///< frame ids count modulo 2^16, 2^32 or 2^64; 0: there are none
    uint32_t hold = 24;    ///< frames
  };
  /// A frame as it comes: in periods from any time on, and what else tells of it.
  struct Frame {
    uint64_t token = 0;          ///< the caller's name for it
    std::optional<double> time;  ///< periods
    std::optional<uint64_t> id;
    uint64_t content = 0;  ///< a fingerprint of its pixels; 0: not known. Other pixels are another
                           ///< frame
  };
  struct Counted {
    enum class Fate : uint8_t {
      trigger,       ///< `trigger` is certain
      contradicted,  ///< `trigger` is what times say, and the picture says that it is another
      off,           ///< too far from the time of any trigger, or without a time
      ambiguous,     ///< explanations did not agree in time
    };
    uint64_t token = 0;
    Fate fate = Fate::off;
    int64_t trigger = 0;
    bool late = false;      ///< of `off`: it is behind where it could be
    bool conflict = false;  ///< of `off`: its time is that of the frame before, its pixels are not
  };
  /// Whether the picture cannot be of this trigger. Asked while frames are pushed.
  using Contradicts = std::function<bool(int64_t trigger, const Frame& frame)>;

  explicit TriggerCounter(const Params& params) : params_(params) { restart(); }

  /// Takes the next frame as it arrives; returns those that are settled by it, in the order of
  /// arrival but for frames that are `off`, which are told at once.
  std::vector<Counted> push(const Frame& frame, const Contradicts& contradicts);
  /// Nothing more comes: those that are held.
  std::vector<Counted> drain();
  /// Those that are held are forgotten, and the next frame may be from any time, also an earlier
  /// one; the count goes on from it.
  void flush();
  /// Counting starts anew with the next frame.
  void restart();
  /// Changes with every restart, also with those of its own, where nothing fits any more: triggers
  /// of different epochs do not compare.
  uint64_t epoch() const { return epoch_; }
  /// Rate of the triggers in periods of the time stamps' clock: between these.
  double slowest() const { return slow_; }
  double fastest() const { return fast_; }

 private:
  struct Explanation {
    double low = 0, high = 0;      ///< time of `trigger`
    int64_t trigger = 0;           ///< of the latest frame
    uint64_t id = 0, content = 0;  ///< of that frame
    std::deque<int64_t> held;      ///< triggers of the frames in `held_`
    bool by_id = false;            ///< `id` is known
    bool operator==(const Explanation& other) const {
      return trigger == other.trigger && held == other.held;
    }
  };
  struct Held {
    uint64_t token;
    bool contradicted;
  };
  std::vector<Explanation> fitting(const Explanation& before, const Frame& frame,
                                   bool use_id) const;
  void add_if_fitting(const Explanation& before, const Frame& frame, int64_t step,
                      std::vector<Explanation>& to) const;
  void settle(std::vector<Counted>& out);
  void give_up(std::vector<Counted>& out);
  void measure_rate();

  Params params_;
  std::vector<Explanation> explanations_;
  std::deque<Held> held_;
  uint64_t epoch_ = 0;
  uint32_t off_in_row_ = 0, unsettled_in_row_ = 0;
  double slow_ = 1, fast_ = 1;  // periods a trigger takes: least and most
  struct {
    int64_t trigger;
    double low, high;
  } checkpoint_{};
  bool anywhere_ = false;            // after a flush
  bool skips_zero_possible_ = true;  // ids that wrap from the largest to 1
};

}  // namespace inverse
