// SPDX-License-Identifier: LGPL-2.1-or-later
// Direct and indirect light of single pixels, needles, and the largest frame that the device
// allows: as of any other frame, or one clear error.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/error.hpp"
#include "global_methods.hpp"

namespace inverse::extremes {
namespace {

class GlobalSizes : public testing::TestWithParam<Solver> {
 protected:
  const Lab lab_;

  /// As little work as there can be.
  void make_quick(GlobalMethod& method) const {
    if (GetParam() == Solver::global) {
      GlobalIntrinsic::Params params;
      params.cycles = 1;
      params.adaptive = false;
      method.set(params);
    } else {
      GlobalThesisParams params;
      params.steps = params.pcg_iterations = 1;
      params.keyframes = params.samples = params.refine_rounds = 0;
      params.clusters = 4;
      method.set(params);
    }
  }
};

Pixels ramp(Extent extent) {
  Pixels pixels(4 * extent.pixels());
  for (size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = i % 4 == 3 ? 1 : 0.05F + 0.9F * static_cast<float>((i / 4 * 7 + i % 4) % 257) / 257;
  return pixels;
}

TEST_P(GlobalSizes, SmallFramesAndNeedlesAreDecomposedAsAnyOther) {
  const Check check = check_global_with(lab_);
  for (const uint32_t length : {1U, 2U, 3U, 7U, 17U, 41U, 1021U})
    for (const uint32_t width : {1U, 3U})
      for (const bool upright : {false, true}) {
        Case one{GetParam(), length, width, 2, length, 0, 0};
        if (upright) std::swap(one.width, one.height);
        const auto wrong = check(one);
        EXPECT_FALSE(wrong) << one.text() << ": " << *wrong;
      }
}

TEST_P(GlobalSizes, LongNeedlesAreDecomposedOrRefusedByName) {
  for (const Extent extent : {Extent{16381, 1}, Extent{1, 16381}, Extent{1, 65537}}) {
    const Pixels input = ramp(extent);
    try {
      GlobalMethod method(lab_, GetParam(), extent);
      make_quick(method);
      const auto wrong = wrong_global_layers(GetParam(), 0, input, method.decompose(input));
      EXPECT_FALSE(wrong) << extent.width << "x" << extent.height << ": " << *wrong;
    } catch (const Error& error) {
      // Kernels have a row of workgroups for every row of pixels.
      EXPECT_GT(extent.height, lab_.device()->limits().workgroups[1]) << error.what();
      EXPECT_EQ(error.kind(), ErrorKind::limit);
      EXPECT_NE(std::string(error.what()).find("maxComputeWorkGroupCount"), std::string::npos)
          << error.what();
    }
  }
}

TEST_P(GlobalSizes, TheLargestFrameIsDecomposedAndOnePixelMoreIsRefusedByName) {
  const gpu::Device& device = *lab_.device();
  const uint64_t bytes = device.limits().storage_buffer_bytes / 16;
  const uint64_t largest =
      device.variant().portable ? bytes : std::min(bytes, device.limits().texel_elements);
  if (largest > uint64_t{1} << 24) GTEST_SKIP() << "frames of this device are too large for a test";
  const uint64_t held_before = device.memory_bytes();
  // The thesis' field of K layers lies plane behind plane in one buffer, and so do what samples are
  // drawn from.
  const uint64_t planes = GetParam() == Solver::global ? 1 : 2;
  const Extent extent{4096, static_cast<uint32_t>(largest / planes / 4096)};
  {
    GlobalMethod method(lab_, GetParam(), extent);
    make_quick(method);
    const Pixels input = ramp(extent);
    const auto wrong = wrong_global_layers(GetParam(), 0, input, method.decompose(input));
    EXPECT_FALSE(wrong) << *wrong;
    printf("  %s: %.0f bytes a pixel at the peak\n", name_of(GetParam()),
           static_cast<double>(device.memory_peak_bytes()) / static_cast<double>(extent.pixels()));
  }
  const Extent more{4096, static_cast<uint32_t>(largest / 4096 + 1)};
  try {
    GlobalMethod method(lab_, GetParam(), more);
    make_quick(method);
    method.decompose(Pixels(4 * more.pixels(), 0.5F));
    ADD_FAILURE() << more.pixels() << " pixels were decomposed";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::limit);
    const std::string text = error.what();
    EXPECT_TRUE(text.find("maxStorageBufferRange") != std::string::npos ||
                text.find("maxTexelBufferElements") != std::string::npos)
        << text;
  }
  EXPECT_EQ(device.memory_bytes(), held_before) << "what was made must go";
}

INSTANTIATE_TEST_SUITE_P(All, GlobalSizes, testing::ValuesIn(kGlobalMethods), [](const auto& info) {
  return std::string(info.param == Solver::global ? "global" : "thesis");
});

}  // namespace
}  // namespace inverse::extremes
