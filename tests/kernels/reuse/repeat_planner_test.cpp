// SPDX-License-Identifier: LGPL-2.1-or-later
// Which frames reuse all layers of the frame before, without a device.
#include "kernels/reuse/repeat_planner.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "kernels/reuse/repeats.hpp"

namespace inverse::testing {
namespace {

struct Video {
  RepeatPlanner planner;
  uint64_t number = 0;
  bool converges = false;  // once a frame of the picture is completed

  /// The next frame, of a new picture or of the one before.
  RepeatPlanner::Decision next(bool repeated, bool params_changed = false, bool adaptive = true,
                               bool layers_available = true) {
    const bool completed = planner.completed(number).has_value();
    return planner.next({.number = number++,
                         .adaptive = adaptive,
                         .repeated = repeated,
                         .params_changed = params_changed,
                         .layers_available = layers_available,
                         .converged = converges && completed});
  }
};

}  // namespace

TEST(RepeatPlanner, AStillPictureIsReusedOnceItHasConverged) {
  Video video;
  for (int k = 0; k < 8; ++k) EXPECT_FALSE(video.next(k > 0).reuse) << k;
  video.converges = true;
  for (int k = 0; k < 8; ++k) EXPECT_TRUE(video.next(true).reuse) << k;
  EXPECT_FALSE(video.next(false).reuse) << "another picture";
  // Its first completed frame is three frames old.
  for (int k = 0; k < 2; ++k) {
    const auto decision = video.next(true);
    EXPECT_TRUE(decision.reuse) << "up to four times as the picture before: " << decision.reason;
  }
}

TEST(RepeatPlanner, ConvergenceIsThatOfTheSamePictureAndParameters) {
  Video video;
  video.converges = true;
  video.next(false);
  EXPECT_EQ(video.planner.completed(1), std::nullopt);
  EXPECT_EQ(video.planner.completed(2), std::nullopt);
  EXPECT_EQ(video.planner.completed(3), 0U);
  EXPECT_FALSE(video.next(true).reuse);
  EXPECT_FALSE(video.next(true).reuse);
  EXPECT_TRUE(video.next(true).reuse) << "frame 0 is completed and has converged";
  EXPECT_FALSE(video.next(true, true).reuse) << "parameters changed";
  EXPECT_EQ(video.planner.completed(5), std::nullopt) << "frame 2 had other parameters";
  EXPECT_EQ(video.planner.completed(7), 4U);
}

TEST(RepeatPlanner, FilmOnAFasterScreenIsSolvedOncePerPicture) {
  for (const uint64_t times : {2U, 3U, 4U, 5U, 6U}) {
    Video video;
    uint64_t reused = 0;
    for (uint64_t picture = 0; picture < 6; ++picture)
      for (uint64_t k = 0; k < times; ++k) reused += video.next(k > 0).reuse;
    // The first picture does not show how often pictures come; beyond four, layers must converge.
    EXPECT_EQ(reused, 5 * (std::min(times, RepeatPlanner::kMaxRepeats) - 1)) << times;
  }
}

TEST(RepeatPlanner, NothingIsReusedThatIsNotThereOrNotWanted) {
  const auto reuses = [](bool params_changed, bool adaptive, bool layers_available) {
    Video video;
    video.converges = true;
    for (int k = 0; k < 6; ++k) video.next(k > 0);
    return video.next(true, params_changed, adaptive, layers_available).reuse;
  };
  EXPECT_TRUE(reuses(false, true, true));
  EXPECT_FALSE(reuses(true, true, true));
  EXPECT_FALSE(reuses(false, false, true));
  EXPECT_FALSE(reuses(false, true, false));
  Video video;
  video.converges = true;
  for (int k = 0; k < 6; ++k) video.next(k > 0);
  video.planner.reset();
  EXPECT_FALSE(video.next(true).reuse) << "a flush";
}

TEST(Repeats, GoOnForAWhile) {
  Repeats repeats;
  EXPECT_FALSE(repeats.going_on());
  repeats.next(false);
  EXPECT_FALSE(repeats.going_on());
  repeats.next(true);
  EXPECT_TRUE(repeats.going_on());
  for (unsigned i = 1; i < Repeats::kMemory; ++i) {
    repeats.next(false);
    EXPECT_TRUE(repeats.going_on());
  }
  repeats.next(false);
  EXPECT_FALSE(repeats.going_on());
  repeats.next(true);
  repeats.reset();
  EXPECT_FALSE(repeats.going_on());
}

}  // namespace inverse::testing
