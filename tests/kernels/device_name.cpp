// SPDX-License-Identifier: LGPL-2.1-or-later
// Names the device before the tests, which cannot run without one.
#include <gtest/gtest.h>

#include <cstdio>
#include <exception>

#include "kernels/gpu/device.hpp"

namespace inverse::testing {
namespace {

class DeviceName : public ::testing::Environment {
  void SetUp() override {
    try {
      std::printf("device: %s\n", gpu::Device::open()->name().c_str());
    } catch (const std::exception& error) {
      GTEST_FAIL() << error.what();
    }
  }
};

[[maybe_unused]] const auto* const kRegistered =
    ::testing::AddGlobalTestEnvironment(new DeviceName);

}  // namespace
}  // namespace inverse::testing
