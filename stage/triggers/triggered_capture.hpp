#pragma once
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/error.hpp"
#include "frame_ids.hpp"
#include "stage/controllers/light_driver.hpp"
#include "stage/program/light_program.hpp"

namespace inverse {

/// A camera that takes one frame when it is told to.
class TriggeredCamera {
 public:
  virtual ~TriggeredCamera() = default;
  /// For messages: "Aravis-Fake-1".
  virtual std::string name() const = 0;
  /// Takes a frame. Returns when the camera has heard it; throws Error(connection) where it does
  /// not answer.
  virtual void fire() = 0;
  /// How many bits its frame ids have; 0: its frames come without.
  virtual uint32_t frame_id_bits() const = 0;
};

/// Steps the lights and takes one frame of every camera in each step: no camera is triggered before
/// the lights have changed, and the lights do not change before all frames are there. So the
/// trigger of a frame is the one that is waited for; nothing is estimated.
///
/// A camera whose frame does not come in time is triggered again in the same light. What it still
/// owes after that is waited for, twice the time from its last trigger, so that a late frame
/// cannot be taken for one of the next step; where frames have ids or times, these are asked, too.
///
/// The loop has a thread of its own. `frame` and `done` are called by the threads that the frames
/// come on.
class TriggeredCapture {
 public:
  struct Params {
    double timeout = 1;     ///< seconds that a frame may take
    uint32_t retries = 2;   ///< how often a camera is triggered again for a step
    uint32_t patience = 3;  ///< steps in a row without a frame of some camera, then it is an error
    /// Seconds that are waited for at least after the lights, for stages whose program says less.
    double guard = 0;
  };
  /// Called from the loop's thread.
  struct Listener {
    /// The frames of `trigger` will not be complete: those of these cameras are missing.
    std::function<void(uint64_t trigger, const std::vector<size_t>& cameras)> lost;
    /// Nothing more comes: the program has ended.
    std::function<void()> ended;
    /// Nothing more comes, for this reason (lights or cameras).
    std::function<void(const Error& error)> failed;
  };
  struct Stats {
    uint64_t triggers = 0;   ///< steps whose frames are all there
    uint64_t fired = 0;      ///< of all cameras
    uint64_t retried = 0;    ///< of these, fired again
    uint64_t dropped = 0;    ///< steps of which frames are missing
    uint64_t surplus = 0;    ///< frames that nobody waited for
    uint64_t ambiguous = 0;  ///< frames that by their id could be of another trigger
    uint64_t late = 0;       ///< frames older than the trigger that was waited for
    uint64_t early = 0;      ///< frames before the first trigger
  };

  /// All have to outlive it. Lights are `driver`'s, whose program is `program` already.
  TriggeredCapture(const LightProgram& program, LightDriver& driver,
                   std::vector<TriggeredCamera*> cameras, const Params& params, Listener listener);
  ~TriggeredCapture();
  TriggeredCapture(const TriggeredCapture&) = delete;
  TriggeredCapture& operator=(const TriggeredCapture&) = delete;

  /// Goes on from `trigger`.
  void start(uint64_t trigger = 0);
  /// Ends the loop and waits for its thread: as long as a camera or the lights take to answer.
  /// Where it can go on.
  uint64_t stop();
  /// Whether the loop was started and not stopped; it may have come to its end.
  bool running() const;

  /// A frame has come from `camera`: its trigger, or nothing where it belongs to none and has to
  /// be dropped. `id` is the camera's, `age` how many seconds ago it was exposed or began to
  /// arrive, where they are known. Every call is to be followed by one of `done`.
  std::optional<uint64_t> frame(size_t camera, std::optional<uint64_t> id,
                                std::optional<double> age = std::nullopt);
  /// The thread of that frame is free for the next one. No trigger is fired before.
  void done(size_t camera);

  Stats stats() const;

 private:
  struct State {
    TriggeredCamera* camera = nullptr;
    FrameIds ids{16};
    bool there = false;    ///< its frame of the trigger that is waited for
    uint32_t owed = 0;     ///< fired in this step and not come
    uint32_t earlier = 0;  ///< fired in earlier steps and never come: ids could still be theirs
    uint32_t busy = 0;     ///< frames that are being handled
    uint32_t missing = 0;  ///< steps in a row without one
    uint32_t backwards = 0;
    std::chrono::steady_clock::time_point fired{};  ///< first in this step
    bool unasked = false;  ///< in this step a frame came that nobody triggered
    uint32_t unasked_steps = 0;
  };
  using Clock = std::chrono::steady_clock;

  void run(uint64_t trigger);
  void step(uint64_t trigger);
  void fire(const std::vector<size_t>& cameras);
  bool wait_for_all(std::unique_lock<std::mutex>& lock, bool owed);
  void pause(double seconds);
  std::vector<size_t> missing() const;
  bool doubtful(State& state, std::optional<uint64_t> id) const;

  const LightProgram& program_;
  LightDriver& driver_;
  const Params params_;
  const Listener listener_;

  mutable std::mutex mutex_;
  std::condition_variable news_;
  std::vector<State> cameras_;
  std::optional<uint64_t> awaited_;
  Clock::time_point last_fired_{};  ///< of any camera
  uint64_t next_ = 0;
  Stats stats_;
  bool stopping_ = true;
  std::thread thread_;
};

}  // namespace inverse
