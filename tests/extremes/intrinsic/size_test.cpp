// SPDX-License-Identifier: LGPL-2.1-or-later
// Frames of a single pixel, needles, and the largest that the device allows: as any other frame, or
// one clear error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "check.hpp"
#include "methods.hpp"
#include "tests/update_max.hpp"

namespace inverse::extremes {
namespace {

class Sizes : public testing::TestWithParam<Solver> {
 protected:
  const Lab lab_;
};

class LargestFrame : public Sizes {};

/// Primes and powers of two and their neighbors, both ways.
TEST_P(Sizes, SmallFramesAndNeedlesAreDecomposedAsAnyOther) {
  const Check check = check_with(lab_);
  for (const uint32_t length : {1U, 2U, 3U, 5U, 7U, 16U, 17U, 97U, 1021U})
    for (const uint32_t width : {1U, 3U})
      for (const bool upright : {false, true}) {
        Case one{GetParam(), length, width, 2, length, 0, 0};
        if (upright) std::swap(one.width, one.height);
        const auto wrong = check(one);
        EXPECT_FALSE(wrong) << one.text() << ": " << *wrong;
      }
}

/// Finite everywhere, and intrinsicdecomp's layers the input at sampled pixels.
void expect_sound(Solver solver, Extent extent, const Pixels& input, const Pixels& got) {
  const std::string name = std::to_string(extent.width) + "x" + std::to_string(extent.height);
  size_t broken = 0;
  for (const float value : got) broken += std::isfinite(value) && value >= 0 ? 0 : 1;
  EXPECT_EQ(broken, 0U) << name;
  if (solver != Solver::multigrid) return;
  double worst = 0;
  for (size_t i = 0; i < got.size(); i += 4)
    update_max(worst, static_cast<double>(std::abs(got[i] * got[i + 3] - input[i])));
  EXPECT_LT(worst, 1e-5) << name;
}

Pixels ramp(Extent extent) {
  Pixels pixels(4 * extent.pixels());
  for (size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = i % 4 == 3 ? 1 : 0.05F + 0.9F * static_cast<float>((i / 4 * 7 + i % 4) % 257) / 257;
  return pixels;
}

TEST_P(Sizes, LongNeedlesAreDecomposedOrRefusedByName) {
  for (const Extent extent : {Extent{16381, 1}, Extent{1, 16381}, Extent{1, 65537}}) {
    ThesisParams params;
    params.irls_iterations = 1;
    params.keyframes = 0;
    if (GetParam() == Solver::schwarz) params.solver = ThesisParams::Solver::schwarz;
    const Pixels input = ramp(extent);
    try {
      Method method(lab_, GetParam(), extent);
      if (GetParam() != Solver::multigrid) method.set(params);
      expect_sound(GetParam(), extent, input, method.decompose(input));
    } catch (const Error& error) {
      // The thesis' kernels have a row of workgroups for every row of pixels.
      EXPECT_NE(GetParam(), Solver::multigrid) << error.what();
      EXPECT_GT(extent.height, lab_.device()->limits().workgroups[1]) << error.what();
      EXPECT_EQ(error.kind(), ErrorKind::limit);
      EXPECT_NE(std::string(error.what()).find("maxComputeWorkGroupCount"), std::string::npos)
          << error.what();
    }
  }
}

/// Pixels of the largest plane that the device can bind and, but in the portable variant, view.
uint64_t max_pixels(const gpu::Device& device) {
  const uint64_t bytes = device.limits().storage_buffer_bytes / 16;
  return device.variant().portable ? bytes : std::min(bytes, device.limits().texel_elements);
}

TEST_P(LargestFrame, IsDecomposedAndOnePixelMoreIsRefusedByName) {
  const uint64_t largest = max_pixels(*lab_.device());
  if (largest > uint64_t{1} << 24) GTEST_SKIP() << "frames of this device are too large for a test";
  const Extent extent{4096, static_cast<uint32_t>(largest / 4096)};
  {
    Method method(lab_, GetParam(), extent);
    if (GetParam() == Solver::multigrid) {
      IntrinsicDecomposition::Params params;
      params.cycles = 1;
      method.set(params);
    } else {
      ThesisParams params;
      params.levels = 1;
      params.irls_iterations = params.pcg_iterations = params.samples = 1;
      params.keyframes = 0;
      method.set(params);
    }
    const Pixels input = ramp(extent);
    expect_sound(GetParam(), extent, input, method.decompose(input));
    const double bytes = static_cast<double>(lab_.device()->memory_peak_bytes());
    printf("  %s: %.0f bytes a pixel at the peak\n", name_of(GetParam()),
           bytes / static_cast<double>(extent.pixels()));
  }
  const uint64_t held = lab_.device()->memory_bytes();
  // One pixel more, as near to a square as its divisors allow.
  Extent more{static_cast<uint32_t>(largest + 1), 1};
  for (uint32_t side = 2; uint64_t{side} * side <= largest + 1; ++side)
    if ((largest + 1) % side == 0) more = {static_cast<uint32_t>((largest + 1) / side), side};
  try {
    Method method(lab_, GetParam(), more);
    method.decompose(Pixels(4 * more.pixels(), 0.5F));
    ADD_FAILURE() << more.pixels() << " pixels were decomposed";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::limit);
    const std::string text = error.what();
    EXPECT_TRUE(text.find("maxStorageBufferRange") != std::string::npos ||
                text.find("maxTexelBufferElements") != std::string::npos)
        << text;
  }
  EXPECT_EQ(lab_.device()->memory_bytes(), held) << "what was made before the error must go";
}

// Schwarz has the planes that PCG has.
INSTANTIATE_TEST_SUITE_P(All, LargestFrame, testing::Values(Solver::multigrid, Solver::pcg),
                         [](const auto& info) { return std::string(name_of(info.param)); });
INSTANTIATE_TEST_SUITE_P(All, Sizes, testing::ValuesIn(kSolvers),
                         [](const auto& info) { return std::string(name_of(info.param)); });

}  // namespace
}  // namespace inverse::extremes
