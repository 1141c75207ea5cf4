// SPDX-License-Identifier: LGPL-2.1-or-later
// When a network whose output changes slowly runs again.
#include "kernels/intrinsic/prior/network/network_rate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace inverse::testing {
namespace {

class NetworkRateTest : public ::testing::Test {
 protected:
  /// Whether it runs for an input whose values are all `value`.
  bool due(float value, uint32_t interval = 2) {
    return rate_.due(std::vector<float>(100, value), interval);
  }
  NetworkRate rate_;
};

}  // namespace

TEST_F(NetworkRateTest, RunsEveryIntervalWhileThePictureMoves) {
  float value = 0;
  EXPECT_TRUE(due(value));
  for (const uint32_t interval : {1U, 2U, 3U})
    for (int k = 0; k < 3; ++k)
      for (uint32_t age = 1; age <= interval; ++age) {
        EXPECT_EQ(due(value += 0.02F, interval), age == interval);
        EXPECT_EQ(rate_.age(), age % interval);
      }
}

TEST_F(NetworkRateTest, RunsAtOnceForACutAndAfterAReset) {
  EXPECT_TRUE(due(0));
  EXPECT_FALSE(due(0.05F, 8));
  EXPECT_TRUE(due(0.3F, 8));
  EXPECT_EQ(rate_.age(), 0U);
  EXPECT_FALSE(due(0.35F, 8));
  rate_.reset();
  EXPECT_TRUE(due(0.35F, 8));
}

TEST_F(NetworkRateTest, SleepsWhileThePictureIsTheSame) {
  EXPECT_TRUE(due(0.5F));
  for (int k = 0; k < 100; ++k) EXPECT_FALSE(due(0.5F));
  EXPECT_EQ(rate_.age(), 0U);
  EXPECT_EQ(rate_.runs(), 1U);
  EXPECT_FALSE(due(0.54F));
  EXPECT_EQ(rate_.age(), 1U);
  EXPECT_FALSE(due(0.5F)) << "back to the picture that it ran for";
  EXPECT_EQ(rate_.age(), 0U);
}

TEST_F(NetworkRateTest, RunsSeldomForNoise) {
  EXPECT_TRUE(due(0));
  int runs = 0;
  for (int k = 1; k <= 160; ++k) runs += due(1e-5F * float(k)) ? 1 : 0;
  EXPECT_EQ(runs, 160 / int(2 * NetworkRate::kStillFactor));
}

TEST_F(NetworkRateTest, RunsForNoiseInEachFrameIfTheIntervalIsOne) {
  for (int k = 0; k < 20; ++k) EXPECT_TRUE(due(1e-5F * float(k), 1));
  EXPECT_EQ(rate_.runs(), 20U);
}

TEST_F(NetworkRateTest, TakesNanAndOtherSizesForACut) {
  EXPECT_TRUE(due(0, 8));
  EXPECT_TRUE(due(std::numeric_limits<float>::quiet_NaN(), 8));
  EXPECT_TRUE(due(0, 8));
  EXPECT_TRUE(rate_.due(std::vector<float>(50, 0), 8));
}

}  // namespace inverse::testing
