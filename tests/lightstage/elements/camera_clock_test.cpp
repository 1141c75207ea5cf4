// SPDX-License-Identifier: LGPL-2.1-or-later
// From a camera's clock to the pipeline's, without a camera.
#include "kernels/lightstage/triggers/camera_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "tests/update_max.hpp"

namespace inverse {
namespace {

constexpr int64_t kFrame = 16'666'667;  // ns

TEST(CameraClock, FollowsAClockThatDrifts) {
  for (const double ppm : {-150.0, 0.0, 80.0, 150.0}) {
    SCOPED_TRACE(ppm);
    CameraClock clock;
    std::mt19937 random(3);
    std::exponential_distribution<double> late(1 / 3e6);  // 3 ms
    int64_t before = -1;
    double worst = 0, correction = 0;
    constexpr int64_t kStart = 60 * 120, kEnd = 60 * 600;  // measured after two minutes
    for (int64_t i = 0; i < kEnd; ++i) {
      const int64_t truth = 5'000'000'000 + i * kFrame;
      const auto camera =
          static_cast<uint64_t>(7e12 + static_cast<double>(i) * kFrame * (1 + ppm * 1e-6));
      // The first one comes late, as after a start.
      const int64_t arrival =
          truth + static_cast<int64_t>(late(random)) + (i == 0 ? 40'000'000 : 0);
      const int64_t time = clock.map(camera, arrival);
      ASSERT_GT(time, before);
      if (i > 0) {
        ASSERT_NEAR(static_cast<double>(time - before), kFrame, 1.3e-3 * kFrame);
      }
      before = time;
      if (i < kStart) continue;
      update_max(worst, std::abs(static_cast<double>(time - truth)));
      correction += clock.correction_ppm() / (kEnd - kStart);
    }
    EXPECT_LT(worst, 1e6);  // a millisecond
    EXPECT_EQ(clock.jumps(), 0U);
    EXPECT_NEAR(correction, -ppm, 2);  // its mean: each second measures anew
  }
}

TEST(CameraClock, FollowsACameraThatRestartsItsClock) {
  CameraClock clock;
  int64_t before = -1;
  for (int64_t i = 0; i < 600; ++i) {
    const int64_t now = i * kFrame;
    uint64_t camera = static_cast<uint64_t>(now) + 900'000'000'000;
    if (i >= 200) camera = static_cast<uint64_t>(now) + 5;  // restarted: backwards
    if (i >= 400) camera += 3'000'000'000;                  // set: forwards
    const int64_t time = clock.map(camera, now + 1'000'000);
    ASSERT_GT(time, before);
    before = time;
  }
  EXPECT_NEAR(static_cast<double>(before), 599.0 * kFrame, 5e7);
  EXPECT_EQ(clock.jumps(), 2U);
}

/// A pause without measurements of the clocks' drift.
TEST(CameraClock, IsExactAgainAfterAGap) {
  CameraClock clock;
  for (int64_t i = 0; i < 100; ++i) clock.map(static_cast<uint64_t>(1000 + i * kFrame), i * kFrame);
  const int64_t later = 100 * kFrame + 600'000'000'000;
  const auto camera = static_cast<uint64_t>(1000 + later + 90'000'000);  // 150 ppm fast
  EXPECT_EQ(clock.map(camera, later), later);
  EXPECT_EQ(clock.map(camera + kFrame, later + kFrame), later + kFrame);
  EXPECT_EQ(clock.jumps(), 0U);
}

/// Frames that waited half a second in a machine that was busy say nothing of the clock.
TEST(CameraClock, DoesNotFollowSingleLateFrames) {
  CameraClock clock;
  for (int64_t i = 0; i < 600; ++i) {
    const int64_t late = i % 7 == 3 ? 500'000'000 : 0;
    const int64_t time = clock.map(static_cast<uint64_t>(1000 + i * kFrame), i * kFrame + late);
    ASSERT_NEAR(static_cast<double>(time), static_cast<double>(i * kFrame), 1e5);
  }
  EXPECT_EQ(clock.jumps(), 0U);
}

}  // namespace
}  // namespace inverse
