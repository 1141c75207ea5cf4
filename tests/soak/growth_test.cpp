// SPDX-License-Identifier: LGPL-2.1-or-later
// The measurement of growth: it must detect growth and ignore noise.
#include "growth.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <random>
#include <thread>

namespace inverse::soak {
namespace {

/// Sixty samples of 100 MiB with noise of ±2 MiB; `grow` changes each by its index 0…59.
template <class Grow>
bool judged_good(Grow grow) {
  Growth growth("test", Slack{});
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-2, 2);
  for (int i = 0; i < 60; ++i) {
    Holding holding{100 + noise(random), 3, 12, 15};
    grow(holding, i);
    growth.sample(holding);
  }
  return growth.judge();
}

TEST(Growth, NoiseIsFine) {
  EXPECT_TRUE(judged_good([](Holding&, int) {}));
}
TEST(Growth, WarmUpIsFine) {
  EXPECT_TRUE(judged_good([](Holding& h, int i) { h.resident_mib -= i < 12 ? 50 : 0; }));
}
TEST(Growth, ResidentMemoryIsDetected) {
  EXPECT_FALSE(judged_good([](Holding& h, int i) { h.resident_mib += i / 2.0; }));
}
TEST(Growth, DeviceMemoryIsDetected) {
  EXPECT_FALSE(judged_good([](Holding& h, int i) { h.device_mib += i / 100.0; }));
}
TEST(Growth, FilesAndThreadsAreDetected) {
  EXPECT_FALSE(judged_good([](Holding& h, int i) { h.descriptors += i / 20; }));
  EXPECT_FALSE(judged_good([](Holding& h, int i) { h.threads += i / 20; }));
}
TEST(Growth, OnlyALastingThreadIsDetected) {
  const auto grown = [](std::chrono::milliseconds timeout, std::chrono::milliseconds life) {
    Growth growth("test", Slack{});
    for (int i = 0; i < 4; ++i) growth.sample_now(0);
    const double before = growth.last().threads;
    std::promise<void> sampled;
    std::thread thread([life, done = sampled.get_future()] { done.wait_for(life); });
    growth.sample_now(0, timeout);
    sampled.set_value();
    thread.join();
    return growth.last().threads - before;
  };
  using namespace std::chrono_literals;
  EXPECT_EQ(grown(60s, 50ms), 0);
  EXPECT_EQ(grown(50ms, 60s), 1);
}
TEST(Growth, TooFewSamplesAreNoGrowth) {
  Growth growth("test", Slack{});
  growth.sample({});
  EXPECT_FALSE(growth.judge());
}

}  // namespace
}  // namespace inverse::soak
