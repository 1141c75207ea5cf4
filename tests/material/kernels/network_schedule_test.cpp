// SPDX-License-Identifier: LGPL-2.1-or-later
// Which networks run for a frame, and which are skipped, without a device.
#include "kernels/material/networks/network_schedule.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace inverse::testing {
namespace {

/// A schedule and the video that it plans: an unchanged object of confirmed material.
struct Video {
  NetworkSchedule schedule;
  NetworkSchedule::Params params{true, 8};
  NetworkSchedule::Known known{.square = {10, 20, 100},
                               .found = true,
                               .placed = true,
                               .moved = 0,
                               .converged = true,
                               .changed = {}};

  NetworkSchedule::Plan next() { return schedule.next(params, known); }
  /// Frames of the next `count` that are estimated.
  unsigned estimated(unsigned count) {
    unsigned sum = 0;
    for (unsigned k = 0; k < count; ++k) sum += next().estimates;
    return sum;
  }
  /// Frames of the next `count` whose view goes into a light that begins with it.
  unsigned restarted(unsigned count) {
    unsigned sum = 0;
    for (unsigned k = 0; k < count; ++k) {
      const auto plan = next();
      EXPECT_TRUE(plan.lights || !plan.light_restarts) << "every such view is taken";
      sum += plan.light_restarts;
    }
    return sum;
  }
};

}  // namespace

TEST(NetworkSchedule, AnUnchangedObjectIsEstimatedOnceInSoManyFrames) {
  Video video;
  for (unsigned k = 1; k <= 32; ++k) {
    const auto plan = video.next();
    EXPECT_EQ(plan.estimates, k % 8 == 0) << k;
    EXPECT_TRUE(plan.segments) << "it may begin to move";
    EXPECT_EQ(std::string(plan.skipped).empty(), plan.estimates) << k;
  }
  video.params.estimate_interval = 1;
  EXPECT_EQ(video.estimated(5), 5U);
  video.params.estimate_interval = 0;
  EXPECT_EQ(video.estimated(5), 5U);
}

TEST(NetworkSchedule, AnUnchangedPictureSkipsEvenTheMask) {
  Video video;
  video.known.unchanged = true;
  for (unsigned k = 1; k <= 32; ++k) {
    const auto plan = video.next();
    EXPECT_EQ(plan.segments, k % 8 == 0) << k;
    EXPECT_EQ(plan.estimates, k % 8 == 0) << k;
  }
}

TEST(NetworkSchedule, AMovingOrUncertainObjectIsNotSkipped) {
  const auto estimated = [](const auto& change) {
    Video video;
    change(video);
    return video.estimated(16);
  };
  const float none = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(estimated([](Video&) {}), 2U);
  EXPECT_EQ(estimated([](Video& v) { v.known.moved = ObjectTracker::kMoved; }), 16U);
  EXPECT_EQ(estimated([=](Video& v) { v.known.moved = none; }), 16U);
  EXPECT_EQ(estimated([](Video& v) { v.known.placed = false; }), 16U);
  EXPECT_EQ(estimated([](Video& v) { v.known.converged = false; }), 16U);
  EXPECT_EQ(estimated([](Video& v) { v.params.adaptive = false; }), 16U);
}

TEST(NetworkSchedule, WithoutAnObjectOnlyDetectionRunsOncePerPicture) {
  Video video;
  video.known.found = video.known.placed = false;
  for (int k = 0; k < 3; ++k) {
    const auto plan = video.next();
    EXPECT_TRUE(plan.segments && !plan.estimates);
    EXPECT_STRNE(plan.skipped, "");
  }
  video.known.unchanged = true;
  for (int k = 0; k < 20; ++k) EXPECT_FALSE(video.next().segments);
  video.known.square.x += 1;
  EXPECT_TRUE(video.next().segments) << "another part of the picture";
  EXPECT_FALSE(video.next().segments);
  video.schedule.restart();
  EXPECT_TRUE(video.next().segments);
  video.params.adaptive = false;
  const auto plan = video.next();
  EXPECT_TRUE(plan.segments && plan.estimates) << "nothing is left out";
}

TEST(NetworkSchedule, DrawnLayersAreOfTheCurrentPicture) {
  Video video;
  EXPECT_FALSE(video.next().compares) << "nothing is drawn";
  video.known.draws = true;
  EXPECT_EQ(video.estimated(8), 8U) << "nobody has kept the picture that they are of";
  EXPECT_TRUE(video.next().compares);
  video.known.changed = {.largest = NetworkSchedule::kChanged, .mean = 0};
  EXPECT_EQ(video.estimated(16), 2U);
  video.known.changed = {.largest = 1.01F * NetworkSchedule::kChanged, .mean = 0};
  EXPECT_EQ(video.estimated(16), 16U);
  video.known.draws = false;
  EXPECT_EQ(video.estimated(16), 2U);
  video.known.draws = true;
  video.params.adaptive = false;
  EXPECT_FALSE(video.next().compares) << "every frame has its own";
}

TEST(NetworkSchedule, TheFirstViewsGoIntoTheLightAndThenOneInFour) {
  Video video;
  video.known.finds_light = true;
  video.known.placed = false;  // every frame is estimated
  for (; video.known.views < NetworkSchedule::kEarlyViews; ++video.known.views)
    EXPECT_TRUE(video.next().lights);
  unsigned taken = 0;
  for (int k = 0; k < 40; ++k) taken += video.next().lights;
  EXPECT_EQ(taken, 10U);
  video.known.finds_light = false;
  for (int k = 0; k < 8; ++k) EXPECT_FALSE(video.next().lights);
  video.known.finds_light = true;
  video.known.found = false;
  EXPECT_FALSE(video.next().lights) << "of what?";
}

TEST(NetworkSchedule, ChangedLampsOverAnUnchangedObjectBeginAnotherLight) {
  const CropChange::Difference same{.largest = 0.005F, .mean = 0.001F},
      lamps{.largest = 0.3F, .mean = 0.1F};
  Video video;
  video.known.finds_light = true;
  video.known.views = 100;
  video.known.changed = same;
  EXPECT_EQ(video.restarted(16), 0U);
  video.known.changed = lamps;
  EXPECT_EQ(video.restarted(100), NetworkSchedule::kFollow) << "they never rest: that is no light";
  // Once it is unchanged again, the next change counts.
  video.known.changed = same;
  EXPECT_EQ(video.restarted(16), 0U);
  video.known.changed = lamps;
  EXPECT_EQ(video.restarted(5), 5U);
  video.known.changed = same;
  EXPECT_EQ(video.restarted(16), 0U) << "its lamps rest: views are averaged";
  // The same if they fade: little from one estimate to the next, more since the last change.
  video.known.light_changed = {
      .largest = 0.02F, .mean = 1.01F * NetworkSchedule::kRelit, .moved = 0};
  EXPECT_EQ(video.restarted(1), 1U);
  video.known.light_changed = same;  // since that light
  EXPECT_EQ(video.restarted(16), 0U);
  video.known.light_changed = {
      .largest = 0.02F, .mean = 1.01F * NetworkSchedule::kRelit, .moved = 0.01F};
  EXPECT_EQ(video.restarted(16), 0U) << "it drifts";
  // Where one side of it fades, its picture is another one sooner than its mean is.
  const CropChange::Difference side{.largest = 0.03F, .mean = 0.005F};
  video.known.changed = video.known.light_changed = side;
  EXPECT_EQ(video.restarted(2), 0U);
  EXPECT_EQ(video.estimated(2), 2U);
  video.known.light_changed->mean = 0.011F;
  EXPECT_EQ(video.restarted(1), 1U);
  video.known.changed = video.known.light_changed = same;
  EXPECT_EQ(video.restarted(16), 0U);
  // What has gone has no light, and the next object's is a mean again.
  video.known.changed = lamps;
  EXPECT_EQ(video.restarted(5), 5U);
  video.known.found = false;
  EXPECT_EQ(video.restarted(1), 0U);
  video.known.found = true;
  EXPECT_EQ(video.restarted(16), 0U);
  video.known.changed = same;
  EXPECT_EQ(video.restarted(16), 0U);
  // A picture that changes as the object moves is not of other lamps.
  video.known.changed = {.largest = 0.3F, .mean = 0.05F};
  video.known.moved = 0.05F;
  EXPECT_EQ(video.restarted(16), 0U);
}

}  // namespace inverse::testing
