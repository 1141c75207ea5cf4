// SPDX-License-Identifier: LGPL-2.1-or-later
// The controller behind target-fps and latency-budget, against frames whose times are made up.
#include "gst/decompose/rate_controller.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace inverse {
namespace {

constexpr double kCosts[] = {0.5, 0.6, 0.8, 1.0, 1.5, 3.0};
constexpr size_t kTop = 5;

/// A machine on which a frame of cost 1 takes `ms(time)`, and each frame anything up to `noise`
/// times longer or shorter.
struct Machine {
  std::function<double(double)> ms;
  double noise = 0;
  std::vector<double> costs{std::begin(kCosts), std::end(kCosts)};  // true ones
  std::mt19937 random{7};

  double operator()(double time, size_t level) {
    std::uniform_real_distribution<double> factor(-noise, noise);
    return ms(time) * costs[level] * std::exp2(factor(random));
  }
};

struct Ran {
  size_t frames = 0, over = 0;  // over budget
  size_t lowest = kTop, highest = 0;
  double last_move = 0;
};

/// Runs a source of 30 frames a second from `from` to `to` (seconds).
Ran run(RateController& controller, Machine& machine, double from, double to) {
  Ran result;
  double time = from;
  uint64_t moves = controller.report().moves;
  while (time < to) {
    const size_t level = controller.level();
    const double took = machine(time, level);
    time += std::max(took * 1e-3, 1.0 / 30);
    controller.frame(time, took, level);
    ++result.frames;
    result.over += took > controller.report().budget_ms;
    result.lowest = std::min(result.lowest, controller.level());
    result.highest = std::max(result.highest, controller.level());
    if (controller.report().moves != moves) result.last_move = time;
    moves = controller.report().moves;
  }
  return result;
}

RateController trade_for(double fps, double latency_ms = 0, size_t top = kTop) {
  RateController controller(kCosts);
  controller.set_goal({fps, latency_ms}, top);
  return controller;
}

/// A controller whose goal is thirty frames a second.
class ThirtyFrames : public ::testing::Test {
 protected:
  RateController controller = trade_for(30);
};

TEST(RateController, WithoutAGoalQualityDecides) {
  RateController controller(kCosts);
  for (const size_t top : {kTop, size_t{2}, size_t{3}}) {
    controller.set_goal({}, top);
    for (int i = 0; i < 100; ++i) controller.frame(i, 1e4, top);
    EXPECT_EQ(controller.level(), top);
    EXPECT_EQ(controller.report().moves, 0u);
  }
}

TEST(RateController, TheStricterGoalIsTheBudget) {
  EXPECT_DOUBLE_EQ((RateController::Goal{25, 0}).budget_ms(), 40);
  EXPECT_DOUBLE_EQ((RateController::Goal{0, 15}).budget_ms(), 15);
  EXPECT_DOUBLE_EQ((RateController::Goal{25, 15}).budget_ms(), 15);
  EXPECT_DOUBLE_EQ((RateController::Goal{25, 60}).budget_ms(), 40);
}

TEST_F(ThirtyFrames, WhatFitsStaysAtTheTop) {
  Machine machine{[](double) { return 10.; }, 0.1};  // 30 of 33 ms at the top
  run(controller, machine, 0, 60);
  EXPECT_EQ(controller.level(), kTop);
  EXPECT_EQ(controller.report().moves, 0u);
}

TEST_F(ThirtyFrames, QualityFallsAtOnceAndAsFarAsNeeded) {
  Machine machine{[](double time) { return time < 10 ? 8. : 30.; }};
  run(controller, machine, 0, 10);
  ASSERT_EQ(controller.level(), kTop);
  // 90 ms a frame: only 0.8 and below fit, and of those that leave room.
  const Ran under_load = run(controller, machine, 10, 10.5);
  EXPECT_EQ(controller.level(), 2u);
  EXPECT_LE(under_load.over, RateController::kWindow);
  const Ran later = run(controller, machine, 10.5, 120);
  EXPECT_EQ(later.over, 0u);
  EXPECT_EQ(controller.level(), 2u);
}

TEST_F(ThirtyFrames, ReturnsWhenTheLoadGoesOneLevelAtATime) {
  Machine machine{[](double time) { return time < 60 ? 60. : 8.; }};
  run(controller, machine, 0, 60);
  ASSERT_EQ(controller.level(), 0u);
  size_t before = 0;
  for (double time = 60; time < 75; time += 0.5) {
    run(controller, machine, time, time + 0.5);
    EXPECT_LE(controller.level(), before + 1);
    EXPECT_GE(controller.level(), before);
    before = controller.level();
  }
  EXPECT_EQ(controller.level(), kTop);
}

TEST(RateController, NoiseCausesNoOscillation) {
  // Every load from what fits by far to what nothing fits; times vary by a third up and down.
  for (double ms = 5; ms < 90; ms *= 1.09) {
    RateController controller = trade_for(30);
    Machine machine{[ms](double) { return ms; }, 0.4};
    run(controller, machine, 0, 30);
    const uint64_t moves = controller.report().moves;
    const Ran rest = run(controller, machine, 30, 330);
    EXPECT_LE(controller.report().moves - moves, 12u)
        << ms << " ms: " << controller.report().reason;
    if (ms * kCosts[0] < 20) {
      EXPECT_LT(static_cast<double>(rest.over), 0.35 * static_cast<double>(rest.frames)) << ms;
    }
  }
}

TEST_F(ThirtyFrames, ALevelAboveItsExpectedCostIsTriedEverMoreRarely) {
  // 20 ms at the chosen level; 25 expected above, and 40 found.
  Machine machine{[](double) { return 25.; }, 0.05, {0.5, 0.6, 0.8, 1.6, 2, 3}};
  run(controller, machine, 0, 10);
  const uint64_t early = controller.report().moves;
  const Ran rest = run(controller, machine, 10, 310);
  EXPECT_GE(controller.report().moves - early, 8u) << "it does try";
  EXPECT_LE(controller.report().moves - early, 30u);  // a try in 32 s, and back
  EXPECT_LT(rest.over, rest.frames / 50);
}

TEST_F(ThirtyFrames, ReturnsAlsoAfterManyFailedTries) {
  Machine machine{
      [](double time) { return time < 300 ? 25. : 6.; }, 0.05, {0.5, 0.6, 0.8, 1.6, 2, 3}};
  run(controller, machine, 0, 300);
  ASSERT_LT(controller.level(), 3u);
  run(controller, machine, 300,
      300 + RateController::kMaxTrialWait + 5 * 3 * RateController::kTrialWait);
  EXPECT_EQ(controller.level(), kTop);
}

TEST_F(ThirtyFrames, SingleSlowFramesMoveNothing) {
  int frame = 0;
  Machine machine{[&](double) { return ++frame % 10 == 0 ? 200. : 8.; }};
  run(controller, machine, 0, 60);
  EXPECT_EQ(controller.report().moves, 0u);
}

TEST_F(ThirtyFrames, TheFirstFramesOfAStreamMayTakeLonger) {
  for (int stream = 0; stream < 3; ++stream) {
    controller.forget();
    for (int i = 0; i < 30; ++i) controller.frame(10 * stream + i / 30., i < 3 ? 400 : 20, kTop);
  }
  EXPECT_EQ(controller.report().moves, 0u);
}

TEST_F(ThirtyFrames, FramesOfAnOlderLevelDoNotCount) {
  for (int i = -3; i < 0; ++i) controller.frame(i * 0.1, 8, kTop);
  for (int i = 0; i < 3; ++i) controller.frame(i * 0.1, 60, kTop);
  const size_t level = controller.level();
  ASSERT_LT(level, kTop);
  for (int i = 3; i < 6; ++i) controller.frame(i * 0.1, 60, kTop);  // still in flight
  EXPECT_EQ(controller.level(), level);
}

TEST_F(ThirtyFrames, LatenessDownstreamCountsWhateverFramesTakeHere) {
  Machine machine{[](double) { return 3.; }};
  run(controller, machine, 0, 1);
  double time = 1;
  for (; time < 20; time += 1. / 30) {
    controller.frame(time, machine(time, controller.level()), controller.level());
    controller.late(time, 12);
  }
  EXPECT_EQ(controller.level(), 0u);
  EXPECT_EQ(controller.report().moves, kTop) << controller.report().reason;
  EXPECT_NE(controller.report().reason.find("late"), std::string::npos);
  for (; time < 60; time += 1. / 30) {
    controller.frame(time, machine(time, controller.level()), controller.level());
    controller.late(time, -5);
  }
  EXPECT_EQ(controller.level(), kTop);
}

TEST_F(ThirtyFrames, LatenessOfFramesBeforeAChangeIsIgnored) {
  for (int i = 0; i < 12; ++i) controller.late(0.03 * i, 40);
  EXPECT_EQ(controller.report().moves, 1u);
  for (int i = 12; i < 24; ++i) controller.late(0.03 * i, 40);
  EXPECT_EQ(controller.report().moves, 2u);
}

TEST_F(ThirtyFrames, OneLateFrameIsIgnored) {
  for (int i = 0; i < 300; ++i) {
    controller.frame(i / 30., 8, controller.level());
    controller.late(i / 30., i % 3 == 0 ? 10 : -1);
  }
  EXPECT_EQ(controller.report().moves, 0u);
}

TEST(RateController, QualityIsTheUpperEndAlsoWhileItIsChanged) {
  RateController controller = trade_for(30, 0, 3);
  Machine machine{[](double) { return 3.; }};
  run(controller, machine, 0, 30);
  EXPECT_EQ(controller.level(), 3u);
  controller.set_goal({30, 0}, 1);
  EXPECT_EQ(controller.level(), 1u);
  controller.set_goal({30, 0}, 4);
  EXPECT_EQ(controller.level(), 1u) << "up is slow";
  run(controller, machine, 30, 60);
  EXPECT_EQ(controller.level(), 4u);
  controller.set_goal({}, 4);
  EXPECT_EQ(controller.level(), 4u);
}

TEST_F(ThirtyFrames, ReportsItsExpectedTime) {
  Machine machine{[](double) { return 30.; }};
  run(controller, machine, 0, 10);
  EXPECT_EQ(controller.report().level, controller.level());
  EXPECT_NEAR(controller.report().predicted_ms, 30 * kCosts[controller.level()], 0.1);
  EXPECT_NEAR(controller.report().budget_ms, 33.3, 0.1);
  EXPECT_EQ(controller.report().reason, "down: took 90.0 ms of 33.3 ms");
}

}  // namespace
}  // namespace inverse
