// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "tests/lab.hpp"

namespace inverse::testing {

/// The device between the tests, so that its kernels are built once for all of them. The program
/// closes it before it ends: drivers destroy objects of their own then.
inline std::shared_ptr<gpu::Device>& shared_device() {
  static std::shared_ptr<gpu::Device> device;
  return device;
}

/// A device and the means to move pixels to and fro. The environment variables of
/// gpu::Variant choose the variant.
class GpuTest : public ::testing::Test {
 protected:
  void SetUp() override { shared_device() = device = gpu::Device::open(); }

  gpu::BufferPtr upload(gpu::Element element, const void* data, uint64_t count) {
    auto buffer = gpu::Buffer::create(device, element, count, gpu::Memory::upload);
    if (data) memcpy(buffer->map(), data, count * gpu::element_bytes(element));
    return buffer;
  }
  gpu::BufferPtr buffer(uint64_t count) { return Lab(device).buffer(count); }
  gpu::BufferPtr upload(const Pixels& pixels) { return Lab(device).upload(pixels); }
  Plane plane(Extent extent, const Pixels& pixels = {}) {
    return {extent,
            upload(gpu::Element::vec4, pixels.empty() ? nullptr : pixels.data(), extent.pixels())};
  }
  PlanePtr shared_plane(Extent extent, const Pixels& pixels) {
    return std::make_shared<Plane>(plane(extent, pixels));
  }
  /// Records with `record(commands)`, submits and waits.
  template <typename Record>
  void run(Record record) {
    Lab(device).run(record);
  }
  /// What is in the plane that `record(commands)` returns.
  template <typename Record>
  Pixels result_of(Record record) {
    PlanePtr plane;
    run([&](gpu::Commands& commands) { plane = record(commands); });
    return download(plane);
  }
  /// Plays `count` frames, kFramesInFlight at a time: record(commands, t) records frame t, and
  /// collect(t) follows when it is done. No frame is recorded after a collect() that returns false.
  template <typename Record, typename Collect>
  void play_frames(size_t count, Record record, Collect collect) {
    std::vector<std::unique_ptr<gpu::Commands>> commands;
    for (size_t i = 0; i < gpu::kFramesInFlight; ++i)
      commands.push_back(std::make_unique<gpu::Commands>(device));
    bool more = true;
    size_t recorded = 0, collected = 0;
    const auto collect_next = [&] {
      commands[collected % commands.size()]->wait();
      more &= collect(collected++);
    };
    for (size_t t = 0; t < count; ++t) {
      if (t >= commands.size()) collect_next();
      if (!more) break;
      gpu::Commands& own = *commands[t % commands.size()];
      own.begin();
      record(own, t);
      own.submit();
      ++recorded;
    }
    while (collected < recorded) collect_next();
  }
  Pixels download(const gpu::BufferPtr& buffer) { return Lab(device).download(buffer); }
  Pixels download(const Plane& plane) { return download(plane.buffer); }
  Pixels download(const PlanePtr& plane) { return download(plane->buffer); }
  /// Tolerance is relative where numbers exceed 1.
  static void expect_near(const Pixels& got, const reference::Plane& expected, double tolerance,
                          const std::string& what) {
    ASSERT_EQ(got.size(), 4 * expected.size());
    for (size_t i = 0; i < got.size(); ++i) {
      const double e = expected.data[i / 4][i % 4];
      ASSERT_NEAR(double{got[i]}, e, tolerance * std::max(1.0, std::abs(e)))
          << what << ", value " << i;
    }
  }

  std::shared_ptr<gpu::Device> device;
};

/// A fixture whose tests begin with a device on which nothing has run.
template <typename Fixture>
class OnANewDevice : public Fixture {
 protected:
  void SetUp() override {
    shared_device().reset();
    Fixture::SetUp();
    ASSERT_EQ(this->device->kernels_used(), 0U)
        << "the device is still in use: a test leaks it, or run these alone (*WarmUp.*)";
  }
};

inline Pixels random_pixels(Extent extent, unsigned seed, float low = 0.0f, float high = 1.0f) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(low, high);
  Pixels pixels(extent.pixels() * 4);
  for (float& p : pixels) p = value(random);
  return pixels;
}

/// Whether all numbers are finite.
inline bool all_finite(const Pixels& pixels) {
  return std::all_of(pixels.begin(), pixels.end(), [](float v) { return std::isfinite(v); });
}
/// Whether all numbers may be light: finite and not negative.
inline bool are_light(const Pixels& pixels) {
  return all_finite(pixels) &&
         std::all_of(pixels.begin(), pixels.end(), [](float v) { return v >= 0; });
}

inline std::string name_of(Extent extent) {
  return std::to_string(extent.width) + "x" + std::to_string(extent.height);
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                kInf = std::numeric_limits<float>::infinity();

inline const std::vector<Extent> kOddSizes = {{1, 1},   {2, 3},   {1, 40},    {17, 5},
                                              {15, 10}, {64, 48}, {349, 287}, {8192, 16}};

}  // namespace inverse::testing
