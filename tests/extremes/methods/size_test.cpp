// SPDX-License-Identifier: LGPL-2.1-or-later
// Frames of a single pixel, needles, and the largest that the device allows: as any other frame, or
// one clear error.
#include <gtest/gtest.h>

#include <algorithm>

#include "check.hpp"

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
  for (const uint32_t length : {1U, 2U, 3U, 5U, 7U, 16U, 17U, 41U, 97U, 1021U})
    for (const uint32_t width : {1U, 3U})
      for (const bool upright : {false, true}) {
        Case one{GetParam(), length, width, 2, length, 0, 0};
        if (upright) std::swap(one.width, one.height);
        const auto wrong = check(one);
        EXPECT_FALSE(wrong) << one.text() << ": " << *wrong;
      }
}

/// Little work a frame; as little as there can be, or of the pyramid all levels.
void make_quick(Method& method, Solver solver, bool whole) {
  if (solver == Solver::multigrid && !whole) {
    method.set(IntrinsicDecomposition::Params{.cycles = 1});
  } else if (solver == Solver::global) {
    GlobalIntrinsic::Params params;
    params.cycles = 1;
    params.adaptive = false;
    method.set(params);
  } else if (solver == Solver::global_thesis) {
    GlobalThesisParams params;
    params.steps = params.pcg_iterations = 1;
    params.keyframes = params.samples = params.refine_rounds = 0;
    params.clusters = 4;
    method.set(params);
  } else if (solver != Solver::multigrid) {
    ThesisParams params{.irls_iterations = 1, .keyframes = 0};
    if (!whole) params.levels = params.pcg_iterations = params.samples = 1;
    method.set(params);
  }
}

Pixels ramp(Extent extent) {
  Pixels pixels(4 * extent.pixels());
  for (size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = i % 4 == 3 ? 1 : 0.05F + 0.9F * static_cast<float>((i / 4 * 7 + i % 4) % 257) / 257;
  return pixels;
}

TEST_P(Sizes, LongNeedlesAreDecomposedOrRefusedByName) {
  for (const Extent extent : {Extent{16381, 1}, Extent{1, 16381}, Extent{1, 65537}}) {
    const Pixels input = ramp(extent);
    try {
      Method method(lab_, GetParam(), extent);
      make_quick(method, GetParam(), true);
      const auto wrong = wrong_layers({GetParam()}, 0, input, method.decompose(input));
      EXPECT_FALSE(wrong) << extent.width << "x" << extent.height << ": " << *wrong;
    } catch (const Error& error) {
      // Most kernels have a row of workgroups for every row of pixels.
      EXPECT_NE(GetParam(), Solver::multigrid) << error.what();
      EXPECT_GT(extent.height, lab_.device()->limits().workgroups[1]) << error.what();
      EXPECT_EQ(error.kind(), ErrorKind::limit);
      EXPECT_NE(std::string(error.what()).find("maxComputeWorkGroupCount"), std::string::npos)
          << error.what();
    }
  }
}

/// Pixels of the largest plane that the device can bind and, if kernels read through views, view.
uint64_t max_pixels(const gpu::Device& device) {
  const uint64_t bytes = device.limits().storage_buffer_bytes / 16;
  return std::min(bytes, device.limits().texel_elements);
}

TEST_P(LargestFrame, IsDecomposedAndOnePixelMoreIsRefusedByName) {
  const gpu::Device& device = *lab_.device();
  const uint64_t largest = max_pixels(device);
  if (largest > uint64_t{1} << 24) GTEST_SKIP() << "frames of this device are too large for a test";
  const uint64_t held = device.memory_bytes();
  // globalintrinsicthesis has the field of K layers plane behind plane in one buffer, and so what
  // samples are drawn from.
  const uint64_t planes = GetParam() == Solver::global_thesis ? 2 : 1;
  const Extent extent{4096, static_cast<uint32_t>(largest / planes / 4096)};
  {
    Method method(lab_, GetParam(), extent);
    make_quick(method, GetParam(), false);
    const Pixels input = ramp(extent);
    const auto wrong = wrong_layers({GetParam()}, 0, input, method.decompose(input));
    EXPECT_FALSE(wrong) << *wrong;
    printf("  %s: %.0f bytes a pixel at the peak\n", name_of(GetParam()),
           static_cast<double>(device.memory_peak_bytes()) / static_cast<double>(extent.pixels()));
  }
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
  EXPECT_EQ(device.memory_bytes(), held) << "what was made must go";
}

// Schwarz has the planes that PCG has.
INSTANTIATE_TEST_SUITE_P(All, LargestFrame,
                         testing::Values(Solver::multigrid, Solver::pcg, Solver::global,
                                         Solver::global_thesis),
                         solver_name);
INSTANTIATE_TEST_SUITE_P(All, Sizes, testing::ValuesIn(kSolvers), solver_name);

}  // namespace
}  // namespace inverse::extremes
