// SPDX-License-Identifier: LGPL-2.1-or-later
#include "triggered_capture.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "common/error.hpp"

namespace inverse {
namespace {

struct Stopped {};
constexpr double kMaxClockError = 2e-3;       ///< of a camera's clock, seconds
constexpr uint32_t kMaxUntriggeredSteps = 4;  ///< consecutive steps; then an error

Error runs_freely(const TriggeredCamera& camera) {
  return {ErrorKind::unsupported,
          "the camera " + camera.name() +
              " sends frames without a trigger: switch off its frame rate and its other triggers, "
              "and end other programs that trigger it"};
}

}  // namespace

TriggeredCapture::TriggeredCapture(const LightProgram& program, LightDriver& driver,
                                   const std::vector<TriggeredCamera*>& cameras,
                                   const Params& params, Listener listener)
    : program_(program), driver_(driver), params_(params), listener_(std::move(listener)) {
  if (cameras.empty()) throw Error(ErrorKind::unsupported, "there is no camera to trigger");
  for (TriggeredCamera* camera : cameras) {
    State state;
    state.camera = camera;
    state.ids = FrameIds(camera->frame_id_bits());
    cameras_.push_back(state);
  }
}

TriggeredCapture::~TriggeredCapture() { stop(); }

void TriggeredCapture::start(uint64_t trigger) {
  stop();
  {
    const std::lock_guard lock(mutex_);
    stopping_ = false;
    next_ = trigger;
    for (State& state : cameras_) {
      state.there = false;
      state.earlier += std::exchange(state.outstanding, 0);
      state.missing = 0;
    }
  }
  thread_ = std::thread([this, trigger] { run(trigger); });
}

uint64_t TriggeredCapture::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    awaited_.reset();
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
  const std::lock_guard lock(mutex_);
  return next_;
}

bool TriggeredCapture::running() const {
  const std::lock_guard lock(mutex_);
  return !stopping_;
}

void TriggeredCapture::run(uint64_t trigger) {
  try {
    const auto end = program_.triggers();
    for (; !end || trigger < *end; ++trigger) step(trigger);
    if (listener_.ended) listener_.ended();
  } catch (const Stopped&) {
  } catch (const Error& error) {
    if (listener_.failed) listener_.failed(error);
  } catch (const std::exception& error) {
    if (listener_.failed) listener_.failed(Error(ErrorKind::internal, error.what()));
  }
}

void TriggeredCapture::pause(double seconds) {
  std::unique_lock lock(mutex_);
  const auto until = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double>(seconds));
  if (changed_.wait_until(lock, until, [&] { return stopping_; })) throw Stopped{};
}

std::vector<size_t> TriggeredCapture::missing() const {
  std::vector<size_t> list;
  for (size_t i = 0; i < cameras_.size(); ++i)
    if (!cameras_[i].there) list.push_back(i);
  return list;
}

/// Waits until every camera's frame has arrived, or, if `outstanding`, until all triggered frames
/// have. False after a timeout.
bool TriggeredCapture::wait_for_all(std::unique_lock<std::mutex>& lock, bool outstanding) {
  const auto until = (outstanding ? last_fired_ : Clock::now()) +
                     std::chrono::duration_cast<Clock::duration>(
                         std::chrono::duration<double>((outstanding ? 2 : 1) * params_.timeout));
  const bool complete = changed_.wait_until(lock, until, [&] {
    return stopping_ || std::all_of(cameras_.begin(), cameras_.end(), [&](const State& state) {
             return outstanding ? state.outstanding == 0 : state.there;
           });
  });
  if (stopping_) throw Stopped{};
  return complete;
}

/// Triggers these cameras. Their frames may arrive before it returns.
void TriggeredCapture::fire(const std::vector<size_t>& cameras) {
  for (const size_t i : cameras) {
    {
      const std::lock_guard lock(mutex_);
      if (stopping_) throw Stopped{};
      State& state = cameras_[i];
      if (state.there) continue;  // in the meantime
      last_fired_ = Clock::now();
      if (state.fired == Clock::time_point{}) state.fired = last_fired_;
      ++state.outstanding;
      ++stats_.fired;
    }
    cameras_[i].camera->fire();
  }
}

void TriggeredCapture::step(uint64_t trigger) {
  std::vector<size_t> wanted;
  {
    // No frame may be in a camera's thread while the lights change.
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] {
      return stopping_ || std::all_of(cameras_.begin(), cameras_.end(),
                                      [](const State& state) { return state.busy == 0; });
    });
    if (stopping_) throw Stopped{};
    for (size_t i = 0; i < cameras_.size(); ++i) {
      cameras_[i].there = false;
      cameras_[i].fired = {};
      wanted.push_back(i);
    }
  }
  driver_.show(trigger);
  const LightProgram::Position position = program_.at(trigger);
  double guard = program_.guard;
  if (position.part == LightProgram::Position::Part::step)
    guard = program_.steps[position.index].guard.value_or(guard);
  pause(std::max(guard, params_.guard));
  {
    const std::lock_guard lock(mutex_);
    awaited_ = trigger;
  }
  fire(wanted);

  std::unique_lock lock(mutex_);
  bool complete = wait_for_all(lock, false);
  for (uint32_t again = 0; !complete && again < params_.retries; ++again) {
    const std::vector<size_t> late = missing();
    stats_.retried += late.size();
    lock.unlock();
    fire(late);
    lock.lock();
    complete = wait_for_all(lock, false);
  }
  // Repeated triggers may give several frames; all have to arrive in this light.
  wait_for_all(lock, true);
  const std::vector<size_t> lost = missing();
  awaited_.reset();
  next_ = trigger + 1;
  for (State& state : cameras_) {
    state.earlier += std::exchange(state.outstanding, 0);
    state.missing = state.there ? 0 : state.missing + 1;
    state.untriggered_steps =
        std::exchange(state.untriggered, false) ? state.untriggered_steps + 1 : 0;
    if (state.untriggered_steps >= kMaxUntriggeredSteps) throw runs_freely(*state.camera);
  }
  if (lost.empty()) return;
  ++stats_.dropped;
  lock.unlock();
  if (listener_.lost) listener_.lost(trigger, lost);
  for (const size_t i : lost) {
    const State& state = cameras_[i];
    if (state.missing < params_.max_missing_steps) continue;
    // Frames came, but none was certain to belong to a trigger.
    if (state.untriggered_steps >= params_.max_missing_steps) throw runs_freely(*state.camera);
    throw Error(ErrorKind::connection,
                "no frame came from the camera " + state.camera->name() + " in " +
                    std::to_string(state.missing) + " steps, each triggered " +
                    std::to_string(params_.retries + 1) +
                    " times: is it set to software triggers, and does its stream arrive?");
  }
}

/// Whether a frame may belong to another trigger than the awaited one. Updates the counts of
/// outstanding frames.
bool TriggeredCapture::is_ambiguous(State& state, std::optional<uint64_t> id) const {
  if (!id || state.camera->frame_id_bits() == 0) {
    state.outstanding -= std::min(state.outstanding, 1U);
    return false;
  }
  const auto after = state.ids.after_last(*id);
  if (after && *after < 1) {
    // A late frame, or, if repeated, a camera that restarted its count.
    if (++state.backwards >= 2) state.ids.accept(*id);
    return true;
  }
  state.backwards = 0;
  state.ids.accept(*id);
  if (!after) {
    state.outstanding -= std::min(state.outstanding, 1U);
    return false;
  }
  // Ids count exposures: this one and lost ones before it.
  const uint64_t exposures = static_cast<uint64_t>(*after);
  const uint64_t of_earlier = std::min<uint64_t>(exposures, state.earlier);
  const bool ambiguous = exposures <= state.earlier ||
                         exposures > uint64_t{state.earlier} + uint64_t{state.outstanding};
  state.earlier -= static_cast<uint32_t>(of_earlier);
  state.outstanding -= static_cast<uint32_t>(
      std::min<uint64_t>(state.outstanding, std::max<uint64_t>(exposures - of_earlier, 1)));
  return ambiguous;
}

std::optional<uint64_t> TriggeredCapture::frame(size_t camera, std::optional<uint64_t> id,
                                                std::optional<double> age) {
  const std::lock_guard lock(mutex_);
  State& state = cameras_[camera];
  ++state.busy;
  const bool untriggered = state.outstanding == 0 && state.earlier == 0;
  const uint32_t outstanding = state.outstanding;
  const bool ambiguous = is_ambiguous(state, id);
  const bool late =
      age && state.fired != Clock::time_point{} &&
      std::chrono::duration<double>(Clock::now() - state.fired).count() + kMaxClockError < *age;
  if (late) state.outstanding = outstanding;  // the awaited frame is still to come
  std::optional<uint64_t> trigger;
  if (stats_.fired == 0) {
    ++stats_.early;
  } else if (untriggered || !awaited_ || state.there) {
    ++stats_.surplus;
    state.untriggered = state.untriggered || untriggered;
  } else if (late) {
    ++stats_.late;
  } else if (ambiguous) {
    ++stats_.ambiguous;
  } else {
    trigger = awaited_;
    state.there = true;
    next_ = *awaited_ + 1;
    if (missing().empty()) ++stats_.triggers;
  }
  changed_.notify_all();
  return trigger;
}

void TriggeredCapture::done(size_t camera) {
  const std::lock_guard lock(mutex_);
  --cameras_[camera].busy;
  changed_.notify_all();
}

TriggeredCapture::Stats TriggeredCapture::stats() const {
  const std::lock_guard lock(mutex_);
  return stats_;
}

}  // namespace inverse
