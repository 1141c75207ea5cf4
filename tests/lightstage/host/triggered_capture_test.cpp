// SPDX-License-Identifier: LGPL-2.1-or-later
// Cameras triggered in step with the lights, simulated by threads that lose, delay and invent
// frames. In all cases, a labeled frame was exposed in that light.
#include "kernels/lightstage/triggers/triggered_capture.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <mutex>
#include <random>
#include <thread>

#include "tests/expect_error.hpp"

namespace inverse {
namespace {

using std::chrono::milliseconds;

/// Records the state of the lights.
class Lights : public LightDriver {
 public:
  void upload(const LightProgram&) override {}
  void show(uint64_t trigger) override {
    if (fails_at >= 0 && trigger >= static_cast<uint64_t>(fails_at.load()))
      throw Error(ErrorKind::connection, "the controller does not answer");
    lit = static_cast<int64_t>(trigger);
  }
  void black() override { lit = -1; }
  std::atomic<int64_t> lit{-1}, fails_at{-1};
};

/// A camera: each trigger exposes the present light; its frame arrives later.
class Camera : public TriggeredCamera {
 public:
  enum class Deed { frame, lost_trigger, lost_frame, late_frame, same_again, another, amid_others };

  Camera(Lights& lights, uint32_t bits, uint64_t first_id)
      : lights_(lights), bits_(bits), id_(first_id) {}
  ~Camera() override { end(); }

  std::string name() const override { return "Fake-7"; }
  uint32_t frame_id_bits() const override { return bits_; }
  void fire() override {
    if (dead) throw Error(ErrorKind::connection, "the camera Fake-7 does not answer");
    const std::lock_guard lock(mutex_);
    const Deed deed = deeds.empty() ? Deed::frame : deeds.front();
    if (!deeds.empty()) deeds.pop_front();
    if (deed == Deed::lost_trigger) return;
    if (deed == Deed::amid_others) expose(milliseconds(0), false);
    expose(deed == Deed::late_frame ? milliseconds(late) : milliseconds(1),
           deed != Deed::lost_frame);
    if (deed == Deed::same_again) expose(milliseconds(late), true, true);
    if (deed == Deed::another || deed == Deed::amid_others) expose(milliseconds(late), true);
  }
  void plan(const std::deque<Deed>& next) {
    const std::lock_guard lock(mutex_);
    deeds = next;
  }
  /// A frame triggered by another program.
  void fire_untriggered() {
    const std::lock_guard lock(mutex_);
    expose(milliseconds(0), true);
  }

  void begin(TriggeredCapture& capture, size_t index) {
    thread_ = std::thread([this, &capture, index] {
      while (!ended_) {
        std::this_thread::sleep_for(milliseconds(1));
        for (;;) {
          Exposure exposure;
          {
            const std::lock_guard lock(mutex_);
            if (exposures_.empty() || exposures_.front().when > Clock::now()) break;
            exposure = exposures_.front();
            exposures_.pop_front();
          }
          const std::chrono::duration<double> age = Clock::now() - exposure.exposed;
          const auto label =
              capture.frame(index, bits_ ? std::optional<uint64_t>(exposure.id) : std::nullopt,
                            tells_age ? std::optional<double>(age.count()) : std::nullopt);
          if (label) {
            ++labeled;
            if (static_cast<int64_t>(*label) != exposure.lit) ++mislabeled;
            last = *label;
          } else {
            ++refused;
          }
          std::this_thread::sleep_for(milliseconds(slow));
          if (lights_.lit != exposure.lit && label) ++stepped_while_busy;
          capture.done(index);
        }
      }
    });
  }
  void end() {
    ended_ = true;
    if (thread_.joinable()) thread_.join();
  }

  std::deque<Deed> deeds;  ///< faults of the next triggers
  std::atomic<bool> dead{false};
  int late = 80, slow = 0;  ///< ms
  bool tells_age = false;
  std::atomic<uint64_t> labeled{0}, mislabeled{0}, refused{0}, last{0}, stepped_while_busy{0};

 private:
  using Clock = std::chrono::steady_clock;
  struct Exposure {
    Clock::time_point when, exposed;
    uint64_t id = 0;
    int64_t lit = -1;
  };
  void expose(milliseconds after, bool comes, bool same = false) {
    if (!same) id_ = bits_ == 16 && id_ == 65535 ? 1 : id_ + 1;
    const Exposure exposure{Clock::now() + after, Clock::now(), id_, lights_.lit};
    if (!comes) return;
    auto at = exposures_.end();
    while (at != exposures_.begin() && std::prev(at)->when > exposure.when) --at;
    exposures_.insert(at, exposure);
  }

  Lights& lights_;
  uint32_t bits_;
  uint64_t id_;
  std::mutex mutex_;
  std::deque<Exposure> exposures_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

/// Black, two lights, black … without end or `passes` times.
LightProgram small_program(uint64_t passes) {
  LightProgram program;
  program.name = "small";
  program.lights = stage_lights({{0, 0, 1}, {1, 0, 0}});
  program.marker = LightProgram::Marker::none;
  program.repeat = passes;
  program.steps = {{StepKind::olat, 0}, {StepKind::olat, 1}};
  program.check();
  return program;
}

class Capture : public ::testing::Test {
 protected:
  /// Runs a program to its end or `seconds`.
  void run(const LightProgram& program, std::vector<Camera*> cameras,
           const TriggeredCapture::Params& params, double seconds = 60) {
    TriggeredCapture::Listener listener;
    listener.lost = [this](uint64_t trigger, const std::vector<size_t>&) {
      const std::lock_guard lock(mutex_);
      lost_.push_back(trigger);
    };
    listener.ended = [this] { ended_ = true; };
    listener.failed = [this](const Error& error) {
      const std::lock_guard lock(mutex_);
      error_ = error.what();
      kind_ = error.kind();
      ended_ = true;
    };
    TriggeredCapture capture(program, lights_,
                             std::vector<TriggeredCamera*>(cameras.begin(), cameras.end()), params,
                             listener);
    for (size_t i = 0; i < cameras.size(); ++i) cameras[i]->begin(capture, i);
    capture.start();
    const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!ended_ && std::chrono::steady_clock::now() < until) {
      if (meanwhile_) meanwhile_();
      std::this_thread::sleep_for(milliseconds(2));
    }
    EXPECT_TRUE(ended_) << "it hangs";
    next_ = capture.stop();
    for (Camera* camera : cameras) camera->end();
    stats_ = capture.stats();
  }

  Lights lights_;
  std::atomic<bool> ended_{false};
  std::function<void()> meanwhile_;
  std::mutex mutex_;
  std::vector<uint64_t> lost_;
  std::string error_;
  ErrorKind kind_ = ErrorKind::internal;
  uint64_t next_ = 0;
  TriggeredCapture::Stats stats_;
};

using Deed = Camera::Deed;

TEST_F(Capture, EveryStepHasItsFramesAndIdsWrap) {
  Camera left(lights_, 16, 65400), right(lights_, 64, uint64_t{1} << 40);
  run(small_program(150), {&left, &right}, {});
  EXPECT_EQ(error_, "");
  EXPECT_EQ(left.labeled, 300U);
  EXPECT_EQ(right.labeled, 300U);
  EXPECT_EQ(left.mislabeled + right.mislabeled, 0U);
  EXPECT_EQ(stats_.triggers, 300U);
  EXPECT_EQ(stats_.fired, 600U);
  EXPECT_EQ(stats_.dropped + stats_.surplus + stats_.ambiguous + stats_.retried, 0U);
  EXPECT_EQ(next_, 300U);
}

TEST_F(Capture, WhatIsLostIsTakenAgainInTheSameLight) {
  Camera camera(lights_, 16, 65530);
  camera.deeds = {Deed::frame, Deed::lost_trigger, Deed::frame, Deed::frame,
                  Deed::frame, Deed::lost_frame,   Deed::frame, Deed::late_frame};
  run(small_program(10), {&camera}, {.timeout = .05});
  EXPECT_EQ(error_, "");
  EXPECT_EQ(camera.labeled, 20U);
  EXPECT_EQ(camera.mislabeled, 0U);
  EXPECT_GE(stats_.retried, 3U);
  EXPECT_EQ(stats_.dropped, 0U);
}

/// Information of a camera's frames: id, age, both, or none.
struct FrameInfo {
  uint32_t bits;
  bool age;
};
class Mislabeled : public Capture, public ::testing::WithParamInterface<FrameInfo> {};

/// In all cases, no label is wrong.
TEST_P(Mislabeled, Nothing) {
  const auto [bits, age] = GetParam();
  Camera camera(lights_, bits, 65500), other(lights_, bits, 65400);
  camera.tells_age = other.tells_age = age;
  // Without id and age, a late frame arrives while the capture still waits for it. Two exposures
  // per trigger need an age.
  const bool blind = bits == 0 && !age;
  std::mt19937 random(7 + bits);
  for (int i = 0; i < 200; ++i) {
    const uint32_t dice = random() % 100;
    camera.deeds.push_back(dice < 4                         ? Deed::lost_trigger
                           : dice < 8                       ? Deed::lost_frame
                           : dice < 12                      ? Deed::late_frame
                           : dice < 15 && !blind            ? Deed::same_again
                           : dice >= 15 && dice < 18 && age ? Deed::another
                                                            : Deed::frame);
  }
  camera.late = blind ? 300 : 30;
  run(small_program(60), {&camera, &other}, {.timeout = blind ? .2 : .04, .retries = 4}, 120);
  EXPECT_EQ(error_, "");
  EXPECT_EQ(camera.mislabeled + other.mislabeled, 0U);
  // Every step is complete or reported.
  EXPECT_EQ(stats_.triggers + stats_.dropped, 120U);
  EXPECT_EQ(lost_.size(), stats_.dropped);
  EXPECT_GE(stats_.triggers, 116U);
  EXPECT_GE(stats_.retried, 5U);
}
INSTANTIATE_TEST_SUITE_P(Capture, Mislabeled,
                         ::testing::Values(FrameInfo{16, false}, FrameInfo{64, false},
                                           FrameInfo{16, true}, FrameInfo{0, true},
                                           FrameInfo{0, false}),
                         [](const auto& info) {
                           return "Bits" + std::to_string(info.param.bits) +
                                  (info.param.age ? "Age" : "");
                         });

TEST_F(Capture, StepsWithoutAFrameAreReported) {
  Camera camera(lights_, 16, 1);
  // The second step: three triggers, no frame.
  camera.deeds = {Deed::frame, Deed::lost_frame, Deed::lost_frame, Deed::lost_frame};
  run(small_program(5), {&camera}, {.timeout = .03});
  EXPECT_EQ(error_, "");
  EXPECT_EQ(stats_.dropped, 1U);
  EXPECT_EQ(lost_, std::vector<uint64_t>{1});
  EXPECT_EQ(camera.labeled, 9U);
  EXPECT_EQ(camera.mislabeled, 0U);
}

TEST_F(Capture, ACameraThatSendsNothingIsAnError) {
  Camera camera(lights_, 16, 1), deaf(lights_, 16, 1);
  deaf.deeds.assign(100, Deed::lost_trigger);
  run(small_program(50), {&camera, &deaf}, {.timeout = .02}, 20);
  testing::expect_contains(error_, "no frame came from the camera Fake-7 in 3 steps");
  EXPECT_EQ(kind_, ErrorKind::connection);
  EXPECT_EQ(lost_.size(), 3U);
}

TEST_F(Capture, ACameraThatDoesNotAnswerIsAnError) {
  Camera camera(lights_, 16, 1);
  meanwhile_ = [&] {
    if (camera.labeled > 5) camera.dead = true;
  };
  run(small_program(5000), {&camera}, {}, 20);
  EXPECT_EQ(error_, "the camera Fake-7 does not answer");
}

TEST_F(Capture, LightsThatDoNotAnswerAreAnError) {
  Camera camera(lights_, 16, 1);
  lights_.fails_at = 4;
  run(small_program(50), {&camera}, {}, 20);
  EXPECT_EQ(error_, "the controller does not answer");
  EXPECT_EQ(camera.labeled, 4U);
}

TEST_F(Capture, ACameraThatRunsFreelyIsAnError) {
  Camera camera(lights_, 16, 1);
  camera.slow = 1;
  meanwhile_ = [&] { camera.fire_untriggered(); };
  run(small_program(5000), {&camera}, {}, 30);
  testing::expect_contains(error_, "sends frames without a trigger");
}

/// Nor is it one of whose frames none is surely of a trigger a camera that sends nothing.
TEST_F(Capture, ACameraThatRunsFreelyAndHidesTheTriggeredFramesIsThatErrorToo) {
  Camera camera(lights_, 16, 1);
  camera.late = 10;
  camera.deeds = std::deque<Deed>(60, Deed::amid_others);
  run(small_program(5000), {&camera}, {.timeout = .1}, 30);
  testing::expect_contains(error_, "sends frames without a trigger");
}

/// The lights wait until frames are handled.
TEST_F(Capture, DownstreamSetsThePace) {
  Camera camera(lights_, 16, 1);
  camera.slow = 20;
  run(small_program(10), {&camera}, {.timeout = .5});
  EXPECT_EQ(camera.labeled, 20U);
  EXPECT_EQ(camera.stepped_while_busy, 0U);
  EXPECT_EQ(stats_.retried, 0U);
}

TEST_F(Capture, GuardTimeIsKept) {
  Camera camera(lights_, 0, 0);
  LightProgram program = small_program(3);
  program.rate_numerator = 10;
  program.guard = .04;
  program.steps[1].guard = .01;
  program.check();
  const auto began = std::chrono::steady_clock::now();
  run(program, {&camera}, {});
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  EXPECT_GE(took.count(), 3 * (.04 + .01));
  EXPECT_EQ(camera.labeled, 6U);
}

TEST_F(Capture, StopsAtOnceAndGoesOn) {
  Camera camera(lights_, 16, 65533);
  const LightProgram program = small_program(0);
  TriggeredCapture capture(program, lights_, {&camera}, {.timeout = 30}, {});
  camera.begin(capture, 0);
  capture.start();
  while (camera.labeled < 6) std::this_thread::sleep_for(milliseconds(1));
  {
    // A frame that is waited for does not hold it up.
    camera.plan(std::deque<Deed>(1000, Deed::lost_trigger));
    std::this_thread::sleep_for(milliseconds(30));
    const auto began = std::chrono::steady_clock::now();
    const uint64_t next = capture.stop();
    EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(5));
    EXPECT_GE(next, 6U);
    camera.plan({});
    const uint64_t before = camera.labeled;
    capture.start(next);
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    // The trigger that was lost makes its successor ambiguous: that one is dropped.
    while (camera.refused + camera.labeled < before + 1 && std::chrono::steady_clock::now() < until)
      std::this_thread::sleep_for(milliseconds(1));
    capture.stop();
  }
  EXPECT_EQ(camera.mislabeled, 0U);
}

TEST_F(Capture, AStepWithAFrameIsNotRepeatedAfterAStop) {
  Camera left(lights_, 16, 1), right(lights_, 16, 1);
  right.plan(std::deque<Deed>(1000, Deed::lost_trigger));
  const LightProgram program = small_program(0);
  TriggeredCapture capture(program, lights_, {&left, &right}, {.timeout = 30}, {});
  left.begin(capture, 0);
  right.begin(capture, 1);
  capture.start();
  while (left.labeled < 1) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_EQ(capture.stop(), 1U);
  left.end();
  right.end();
}

TEST(FrameIds, WrapWithoutZero) {
  FrameIds ids(16);
  EXPECT_FALSE(ids.after_last(65400));
  EXPECT_EQ(ids.missed_before(65534), 0U);
  EXPECT_EQ(ids.after_last(65535), 1);
  EXPECT_EQ(ids.after_last(1), 2);
  EXPECT_EQ(ids.after_last(65530), -4);
  EXPECT_EQ(ids.after_last(65534), 0);
  EXPECT_EQ(ids.missed_before(65535), 0U);
  EXPECT_EQ(ids.missed_before(1), 0U);
  EXPECT_EQ(ids.after_last(65535), -1);
  EXPECT_EQ(ids.missed_before(5), 3U);
  // One that does count 0.
  FrameIds zero(16);
  EXPECT_EQ(zero.missed_before(65535), 0U);
  EXPECT_EQ(zero.missed_before(0), 0U);
  EXPECT_EQ(zero.missed_before(1), 0U);
  FrameIds wide(64);
  EXPECT_EQ(wide.missed_before(65535), 0U);
  EXPECT_EQ(wide.missed_before(65536), 0U);
  EXPECT_EQ(wide.after_last(65535), -1);
  EXPECT_EQ(wide.missed_before(~uint64_t{0} - 1), 0U);  // as far behind as ahead: no gap
}

}  // namespace
}  // namespace inverse
