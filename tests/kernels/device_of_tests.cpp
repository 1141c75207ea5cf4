// SPDX-License-Identifier: LGPL-2.1-or-later
// Names the device before the tests, which cannot run without one, and closes it after them.
#include <gtest/gtest.h>

#include <cstdio>
#include <exception>

#include "tests/kernels/gpu_fixture.hpp"

namespace inverse::testing {
namespace {

class DeviceOfTests : public ::testing::Environment {
  void SetUp() override {
    try {
      std::printf("device: %s\n", gpu::Device::open()->name().c_str());
    } catch (const std::exception& error) {
      GTEST_FAIL() << error.what();
    }
  }
  void TearDown() override { shared_device().reset(); }
};

[[maybe_unused]] const auto* const kRegistered =
    ::testing::AddGlobalTestEnvironment(new DeviceOfTests);

}  // namespace
}  // namespace inverse::testing
