// SPDX-License-Identifier: LGPL-2.1-or-later
// Frames of the same trigger from several cameras: which are output, when, and in which order.
#include "kernels/lightstage/triggers/frame_sets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace inverse {
namespace {

FrameSets of_cameras(uint32_t count, bool complete) {
  FrameSets sets(complete);
  for (uint32_t camera = 0; camera < count; ++camera) sets.add_camera(camera);
  return sets;
}

TEST(FrameSets, WaitForEveryCamera) {
  FrameSets sets = of_cameras(2, true);
  sets.add(0, 5, 50);
  EXPECT_TRUE(sets.decide().empty());
  EXPECT_EQ(sets.lacking(), std::vector<uint32_t>{1});
  sets.add(1, 5, 51);
  const auto decided = sets.decide();
  ASSERT_EQ(decided.size(), 2U);
  for (const auto& frame : decided) EXPECT_TRUE(frame.out);
  EXPECT_EQ(sets.complete_sets(), 1U);
}

TEST(FrameSets, ALaterFrameRevealsALostOne) {
  for (const bool complete : {true, false}) {
    FrameSets sets = of_cameras(2, complete);
    sets.add(0, 5, 50);
    sets.add(1, 6, 61);
    const auto decided = sets.decide();
    ASSERT_EQ(decided.size(), 1U);
    EXPECT_EQ(decided[0].token, 50U);
    EXPECT_EQ(decided[0].out, !complete);
    EXPECT_EQ(sets.incomplete_sets(), 1U);
  }
}

TEST(FrameSets, NoWaitForAnIdleOrMissingCamera) {
  FrameSets sets = of_cameras(3, false);
  sets.add(0, 1, 10);
  sets.add(1, 1, 11);
  EXPECT_TRUE(sets.decide().empty());
  sets.wait_for(2, false);
  EXPECT_EQ(sets.decide().size(), 2U);
  sets.add(2, 2, 22);  // it joins all the same
  sets.add(0, 2, 20);
  EXPECT_TRUE(sets.decide().empty());
  sets.remove_camera(1);
  EXPECT_EQ(sets.decide().size(), 2U);
  EXPECT_EQ(sets.complete_sets(), 1U);
  sets.add(0, 3, 30);
  sets.forget_frames(0);
  EXPECT_TRUE(sets.lacking().empty());
}

TEST(FrameSets, ACameraThatIsGoneDoesNotComeBackByItself) {
  FrameSets sets = of_cameras(2, true);
  sets.remove_camera(1);
  sets.forget_frames(1);
  sets.wait_for(1, true);
  sets.add(1, 5, 51);
  sets.add(0, 5, 50);
  EXPECT_TRUE(sets.lacking().empty());
  EXPECT_EQ(sets.decide().size(), 1U);
  EXPECT_EQ(sets.complete_sets(), 1U);
}

TEST(FrameSets, EveryFrameIsDecidedOnceAndInOrder) {
  std::mt19937 random(7);
  constexpr uint32_t kCameras = 4;
  FrameSets sets = of_cameras(kCameras, false);
  std::vector<uint64_t> next(kCameras, 0), last(kCameras, 0);
  uint64_t sent = 0, decided = 0;
  const auto hear = [&] {
    for (const auto& frame : sets.decide()) {
      ++decided;
      EXPECT_GT(frame.token, last[frame.camera]);
      last[frame.camera] = frame.token;
    }
  };
  for (int i = 0; i < 20000; ++i) {
    const uint32_t camera = random() % kCameras;
    next[camera] += random() % 20 == 0 ? 2 : 1;
    sets.add(camera, next[camera], next[camera]);
    ++sent;
    hear();
  }
  for (uint32_t camera = 0; camera < kCameras; ++camera) sets.wait_for(camera, false);
  hear();
  EXPECT_EQ(decided, sent);
  EXPECT_GT(sets.complete_sets(), *std::min_element(next.begin(), next.end()) / 2);
  EXPECT_GT(sets.incomplete_sets(), 0U);
}

}  // namespace
}  // namespace inverse
