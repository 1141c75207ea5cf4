// SPDX-License-Identifier: LGPL-2.1-or-later
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
#include "kernels/lightstage/controllers/light_driver.hpp"
#include "kernels/lightstage/program/light_program.hpp"

namespace inverse {

/// A camera with a software trigger.
class TriggeredCamera {
 public:
  virtual ~TriggeredCamera() = default;
  /// For messages: "Aravis-Fake-1".
  virtual std::string name() const = 0;
  /// Triggers one frame. Returns once the camera has acknowledged; throws Error(connection) if it
  /// does not answer.
  virtual void fire() = 0;
  /// Bits of its frame ids; 0: no ids.
  virtual uint32_t frame_id_bits() const = 0;
};

/// Steps the lights and captures one frame of every camera in each step. Cameras are triggered
/// after the lights have changed, and the lights change after all frames have arrived. So a frame's
/// trigger is always the awaited one.
///
/// If a frame does not arrive in time, its camera is triggered again in the same light. Outstanding
/// frames are awaited for twice the timeout after the last trigger, so that a late frame is not
/// assigned to the next step. Frame ids and ages, if known, are checked, too.
///
/// The loop runs in a thread of its own. Call `frame` and `done` from the threads that receive the
/// frames.
class TriggeredCapture {
 public:
  struct Params {
    double timeout = 1;              ///< of a frame, seconds
    uint32_t retries = 2;            ///< further triggers of a camera per step
    uint32_t max_missing_steps = 3;  ///< consecutive steps without a camera's frame; then an error
    /// Minimum time from a change of the lights to the trigger, seconds.
    double guard = 0;
  };
  /// Called from the loop's thread.
  struct Listener {
    /// The frames of these cameras are missing from `trigger`.
    std::function<void(uint64_t trigger, const std::vector<size_t>& cameras)> lost;
    /// The program has ended.
    std::function<void()> ended;
    /// The loop ended with this error of lights or cameras.
    std::function<void(const Error& error)> failed;
  };
  struct Stats {
    uint64_t triggers = 0;   ///< steps with all frames
    uint64_t fired = 0;      ///< triggers sent to all cameras
    uint64_t retried = 0;    ///< of these, repeated ones
    uint64_t dropped = 0;    ///< steps with missing frames
    uint64_t surplus = 0;    ///< unexpected frames
    uint64_t ambiguous = 0;  ///< frames whose id allows another trigger
    uint64_t late = 0;       ///< frames older than the awaited trigger
    uint64_t early = 0;      ///< frames before the first trigger
  };

  /// All arguments have to outlive it. `program` is already uploaded to `driver`.
  TriggeredCapture(const LightProgram& program, LightDriver& driver,
                   const std::vector<TriggeredCamera*>& cameras, const Params& params,
                   Listener listener);
  ~TriggeredCapture();
  TriggeredCapture(const TriggeredCapture&) = delete;
  TriggeredCapture& operator=(const TriggeredCapture&) = delete;

  /// Starts the loop at `trigger`.
  void start(uint64_t trigger = 0);
  /// Ends the loop and waits for its thread, as long as cameras and lights take to answer. Returns
  /// the next trigger, which no camera has a frame of.
  uint64_t stop();
  /// Whether the loop was started and not stopped; it may have ended by itself.
  bool running() const;

  /// Call it for every frame of `camera`. Returns its trigger; empty: drop the frame. `id` is the
  /// camera's frame id; `age` the seconds since it was exposed or began to arrive, if known. Call
  /// `done` afterwards.
  std::optional<uint64_t> frame(size_t camera, std::optional<uint64_t> id,
                                std::optional<double> age = std::nullopt);
  /// The frame has been handled. The next trigger waits for it.
  void done(size_t camera);

  Stats stats() const;

 private:
  struct State {
    TriggeredCamera* camera = nullptr;
    FrameIds ids{16};
    bool there = false;        ///< the frame of the awaited trigger has arrived
    uint32_t outstanding = 0;  ///< frames triggered in this step that have not arrived
    uint32_t earlier = 0;      ///< outstanding frames of earlier steps; ids may be theirs
    uint32_t busy = 0;         ///< frames being handled
    uint32_t missing = 0;      ///< consecutive steps without a frame
    uint32_t backwards = 0;
    std::chrono::steady_clock::time_point fired{};  ///< first in this step
    bool untriggered = false;                       ///< a frame without trigger came in this step
    uint32_t untriggered_steps = 0;
  };
  using Clock = std::chrono::steady_clock;

  void run(uint64_t trigger);
  void step(uint64_t trigger);
  void fire(const std::vector<size_t>& cameras);
  bool wait_for_all(std::unique_lock<std::mutex>& lock, bool outstanding);
  void pause(double seconds);
  std::vector<size_t> missing() const;
  bool is_ambiguous(State& state, std::optional<uint64_t> id) const;

  const LightProgram& program_;
  LightDriver& driver_;
  const Params params_;
  const Listener listener_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<State> cameras_;
  std::optional<uint64_t> awaited_;
  Clock::time_point last_fired_{};  ///< of any camera
  uint64_t next_ = 0;
  Stats stats_;
  bool stopping_ = true;
  std::thread thread_;
};

}  // namespace inverse
