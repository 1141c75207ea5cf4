// SPDX-License-Identifier: LGPL-2.1-or-later
// Symmetries: mirrored frames have mirrored layers, brighter light changes shading alone, and
// colors are interchangeable.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "global_picture.hpp"
#include "tests/update_max.hpp"

namespace inverse::extremes {
namespace {

using Rgb = GlobalThesis::Rgb;
const std::vector<Rgb> kPaints{{0.8F, 0.15F, 0.1F}, {0.15F, 0.6F, 0.2F}, {0.2F, 0.3F, 0.9F}};

Pixels mirrored(Extent extent, const Pixels& pixels, bool vertically) {
  Pixels result(pixels.size());
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const uint32_t from = vertically ? (extent.height - 1 - y) * extent.width + x
                                       : y * extent.width + extent.width - 1 - x;
      std::copy_n(&pixels[4 * size_t{from}], 4, &result[4 * (size_t{y} * extent.width + x)]);
    }
  return result;
}

Pixels permuted(const Pixels& pixels, const std::array<size_t, 3>& order) {
  Pixels result = pixels;
  for (size_t i = 0; i < pixels.size(); i += 4)
    for (size_t c = 0; c < 3; ++c) result[i + c] = pixels[i + order[c]];
  return result;
}

struct Apart {
  double rms = 0, most = 0;
};
/// Of R, S and light in log units (black counts as 1e-6), of shares as they are.
Apart apart(const GlobalLayers& one, const GlobalLayers& other) {
  Apart result;
  size_t count = 0;
  const auto add = [&](double d) {
    result.rms += d * d;
    update_max(result.most, std::abs(d));
    ++count;
  };
  const auto log_of = [](float v) { return std::log(std::max(static_cast<double>(v), 1e-6)); };
  for (size_t i = 0; i < one.intrinsic.size(); ++i) {
    add(log_of(one.intrinsic[i]) - log_of(other.intrinsic[i]));
    if (i % 4 == 3)
      add(static_cast<double>(one.light[i]) - static_cast<double>(other.light[i]));
    else
      add(log_of(one.light[i]) - log_of(other.light[i]));
  }
  EXPECT_EQ(one.shares.size(), other.shares.size());
  for (size_t n = 0; n < std::min(one.shares.size(), other.shares.size()); ++n)
    for (size_t i = 0; i < one.shares[n].size(); ++i)
      add(static_cast<double>(one.shares[n][i]) - static_cast<double>(other.shares[n][i]));
  result.rms = std::sqrt(result.rms / static_cast<double>(count));
  return result;
}

class GlobalSymmetry : public testing::Test {
 protected:
  const Lab lab_;

  static GlobalIntrinsic::Params converged() {
    GlobalIntrinsic::Params params;
    params.cycles = params.warm_cycles = 32;
    params.tolerances.cycle = 0;
    params.adaptive = false;
    return params;
  }
  /// The second frame of a new object: its gather has the frame's base colors.
  GlobalLayers second(Extent extent, const Pixels& frame, const GlobalIntrinsic::Params& params) {
    GlobalMethod method(lab_, Solver::global, extent);
    method.set(params);
    method.decompose(frame);
    GlobalLayers got = method.decompose(frame);
    scale_ = method.found().solve.scale;
    amount_ = method.found().amount;
    return got;
  }
  GlobalLayers thesis(Extent extent, const Pixels& frame, GlobalThesisParams params,
                      const std::vector<Rgb>& colors = kPaints) {
    params.samples = 0;  // what no random number has a part in
    params.refine_rounds = 0;
    GlobalMethod method(lab_, Solver::global_thesis, extent);
    method.set(params);
    method.thesis().set_base_colors(colors);
    return method.decompose(frame);
  }
  float scale_ = 0, amount_ = 0;
};

TEST_F(GlobalSymmetry, MirroredFramesHaveMirroredLayers) {
  // Whole points of the grid, of its coarse one and of the multigrid's cells.
  const Extent extent{128, 64};
  const Pixels frame = mosaic(extent, 4);
  const GlobalLayers a = second(extent, frame, converged());
  for (const bool vertically : {false, true}) {
    GlobalLayers b = second(extent, mirrored(extent, frame, vertically), converged());
    for (Pixels* plane : {&b.intrinsic, &b.light}) *plane = mirrored(extent, *plane, vertically);
    for (Pixels& plane : b.shares) plane = mirrored(extent, plane, vertically);
    const Apart difference = apart(a, b);
    printf("  mirrored: rms %.2e, most %.2e\n", difference.rms, difference.most);
    // Sums in another order move the confidence in the amount, and where that is low, as in a
    // mosaic of random colors, the color of bounced light goes with it (kSure; 2e-4 without).
    EXPECT_LT(difference.rms, 5e-3) << vertically;
    EXPECT_LT(difference.most, 2e-2) << vertically;
  }
}

TEST_F(GlobalSymmetry, MirroredFramesHaveMirroredLayersOfTheThesis) {
  const Extent extent{61, 43};
  const Pixels frame = mosaic(extent, 4);
  const GlobalLayers a = thesis(extent, frame, {});
  for (const bool vertically : {false, true}) {
    GlobalLayers b = thesis(extent, mirrored(extent, frame, vertically), {});
    for (Pixels* plane : {&b.intrinsic, &b.light}) *plane = mirrored(extent, *plane, vertically);
    for (Pixels& plane : b.shares) plane = mirrored(extent, plane, vertically);
    const Apart difference = apart(a, b);
    printf("  mirrored: rms %.2e, most %.2e\n", difference.rms, difference.most);
    EXPECT_LT(difference.most, 1e-2) << vertically;
    EXPECT_LT(difference.rms, 1e-4) << vertically;
  }
}

TEST_F(GlobalSymmetry, BrighterLightIsBrighterShading) {
  // Far above the floors, where every channel counts as clipped and the amount stays what is
  // typical; and in the range of a camera, where the floor of 0.003 changes chroma and dark points
  // count less.
  const Extent extent{96, 64};
  for (const bool camera : {false, true}) {
    Pixels frame = mosaic(extent, 5);
    for (size_t i = 0; i < frame.size(); ++i)
      if (i % 4 < 3) frame[i] *= camera ? 0.25F : 256;
    const GlobalLayers base = second(extent, frame, converged());
    const float scale = scale_, amount = amount_;
    for (const int n : {1, 2, 4}) {
      if (camera && n == 4) continue;
      Pixels brighter = frame;
      for (size_t i = 0; i < frame.size(); ++i)
        if (i % 4 < 3) brighter[i] = std::ldexp(frame[i], n);
      GlobalLayers got = second(extent, brighter, converged());
      for (size_t i = 3; i < got.intrinsic.size(); i += 4)
        got.intrinsic[i] = std::ldexp(got.intrinsic[i], -n);
      const Apart difference = apart(base, got);
      printf("  %s 2^%d: rms %.2e, most %.2e; amount %.4f to %.4f, scale %.4f to %.4f\n",
             camera ? "camera" : "far above", n, difference.rms, difference.most,
             static_cast<double>(amount), static_cast<double>(amount_), static_cast<double>(scale),
             static_cast<double>(scale_));
      EXPECT_LT(difference.rms, camera ? 0.05 : 2e-4) << n;
      EXPECT_NEAR(amount_, amount, (camera ? 0.1F : 1e-5F) * amount) << n;
    }
  }
}

TEST_F(GlobalSymmetry, BrighterLightIsBrighterShadingOfTheThesisWithItsWeights) {
  // Its terms are squares of the image, sums of light and sums of log reflectance: weights that
  // follow the light make them the same.
  const Extent extent{61, 43};
  Pixels frame = mosaic(extent, 5);
  GlobalThesisParams params;
  params.chroma_floor = params.log_floor = 1e-4F;
  const GlobalLayers base = thesis(extent, frame, params);
  for (const int n : {-2, 1, 2, 4}) {
    Pixels brighter = frame;
    for (size_t i = 0; i < frame.size(); ++i)
      if (i % 4 < 3) brighter[i] = std::ldexp(frame[i], n);
    GlobalThesisParams scaled = params;
    for (float* weight : {&scaled.lambda_data, &scaled.lambda_monochrome})
      *weight = std::ldexp(*weight, -2 * n);
    for (float* weight :
         {&scaled.lambda_i_sparsity, &scaled.lambda_smoothness, &scaled.lambda_non_negativity})
      *weight = std::ldexp(*weight, -n);
    for (float* floor : {&scaled.epsilon, &scaled.chroma_floor, &scaled.log_floor})
      *floor = std::ldexp(*floor, n);
    GlobalLayers got = thesis(extent, brighter, scaled);
    for (size_t i = 3; i < got.intrinsic.size(); i += 4)
      got.intrinsic[i] = std::ldexp(got.intrinsic[i], -n);
    const Apart difference = apart(base, got);
    printf("  2^%d: rms %.2e, most %.2e\n", n, difference.rms, difference.most);
    EXPECT_LT(difference.most, 1e-4) << n;
  }
}

TEST_F(GlobalSymmetry, NoColorIsSpecial) {
  const Extent extent{96, 64};
  const Pixels frame = mosaic(extent, 6);
  GlobalIntrinsic::Params params = converged();
  params.prior.chroma_weight = 0;  // its grid of bins has axes
  const GlobalLayers base = second(extent, frame, params);
  const float amount = amount_;
  std::array<size_t, 3> order{0, 1, 2};
  while (std::next_permutation(order.begin(), order.end())) {
    const GlobalLayers got = second(extent, permuted(frame, order), params);
    GlobalLayers expected = base;
    expected.intrinsic = permuted(base.intrinsic, order);
    expected.light = permuted(base.light, order);
    // Slots go by mass, which bins decide.
    expected.shares = got.shares;
    const Apart difference = apart(expected, got);
    printf("  %zu%zu%zu: rms %.2e, most %.2e; amount %.4f to %.4f\n", order[0], order[1], order[2],
           difference.rms, difference.most, static_cast<double>(amount),
           static_cast<double>(amount_));
    const bool along_axes = order[2] == 2;
    EXPECT_LT(difference.rms, along_axes ? 1e-5 : 0.03);
    // So the histograms whose sharpness decides on the amount.
    EXPECT_NEAR(amount_, amount, (along_axes ? 1e-5F : 0.12F) * amount);
  }
}

TEST_F(GlobalSymmetry, NoColorIsSpecialOfTheThesis) {
  const Extent extent{61, 43};
  const Pixels frame = mosaic(extent, 7);
  const GlobalLayers base = thesis(extent, frame, {});
  std::array<size_t, 3> order{0, 1, 2};
  while (std::next_permutation(order.begin(), order.end())) {
    std::vector<Rgb> colors = kPaints;
    for (size_t k = 0; k < colors.size(); ++k)
      for (size_t c = 0; c < 3; ++c) colors[k][c] = kPaints[k][order[c]];
    const GlobalLayers got = thesis(extent, permuted(frame, order), {}, colors);
    GlobalLayers expected = base;
    expected.intrinsic = permuted(base.intrinsic, order);
    expected.light = permuted(base.light, order);
    const Apart difference = apart(expected, got);
    printf("  %zu%zu%zu: rms %.2e, most %.2e\n", order[0], order[1], order[2], difference.rms,
           difference.most);
    EXPECT_LT(difference.most, 1e-2);
    EXPECT_LT(difference.rms, 1e-4);
  }
}

TEST_F(GlobalSymmetry, AResetForgetsEverything) {
  const Extent extent{61, 44};
  for (const Solver solver : kGlobalMethods) {
    GlobalMethod used(lab_, solver, extent), fresh(lab_, solver, extent);
    for (uint32_t frame = 0; frame < 12; ++frame) {
      Case one = random_case(solver, frame + 1, 64);
      one.width = extent.width, one.height = extent.height;
      used.decompose(frame_of(one, frame));
    }
    used.reset();
    for (unsigned frame = 0; frame < 3; ++frame) {
      const GlobalLayers a = used.decompose(mosaic(extent, 1 + frame / 2)),
                         b = fresh.decompose(mosaic(extent, 1 + frame / 2));
      EXPECT_EQ(a.intrinsic, b.intrinsic) << name_of(solver) << ", frame " << frame;
      EXPECT_EQ(a.light, b.light) << name_of(solver) << ", frame " << frame;
      EXPECT_EQ(a.bases, b.bases) << name_of(solver) << ", frame " << frame;
      EXPECT_EQ(a.shares, b.shares) << name_of(solver) << ", frame " << frame;
    }
  }
}

}  // namespace
}  // namespace inverse::extremes
