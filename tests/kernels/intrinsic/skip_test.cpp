// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicdecomp skips terms and resolution that a scene does not need; history carries over.
#include "intrinsic_fixture.hpp"
#include "kernels/intrinsic/resolution/layer_distance.hpp"
#include "kernels/intrinsic/scaled_intrinsic.hpp"
#include "tests/differences.hpp"

namespace inverse::testing {
namespace {

/// Soft blotches of color under soft light: half the pixels show all there is.
Pixels soft_scene(Extent extent, float phase) {
  Pixels pixels(extent.pixels() * 4, 1);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const float u = static_cast<float>(x) / 40, v = static_cast<float>(y) / 40;
      float* p = &pixels[4 * (static_cast<size_t>(y) * extent.width + x)];
      const float light = 0.5F + 0.3F * std::sin(0.7F * u + 0.4F * v + phase);
      for (size_t c = 0; c < 3; ++c)
        p[c] = light * (0.5F + 0.2F * std::sin(u + 1.7F * v + 2 * static_cast<float>(c) + phase));
    }
  return pixels;
}

bool has_reason(const std::vector<std::string>& skipped, const char* what) {
  return std::any_of(skipped.begin(), skipped.end(),
                     [&](const std::string& reason) { return reason.starts_with(what); });
}

}  // namespace

class SkipTest : public IntrinsicTest {
 protected:
  Pixels frame(ScaledIntrinsic& method, const PlanePtr& in, const ScaledIntrinsic::Params& params,
               bool reset = false) {
    Layers layers;
    run([&](gpu::Commands& commands) { layers = method.record(commands, in, params, {reset}); });
    return download(layers[Role::intrinsic]);
  }
};

TEST_F(SkipTest, BinsWithoutWeightAreAlwaysSkipped) {
  const Extent extent{97, 61};
  const Pixels pixels = scene(extent, 3);
  for (const bool adaptive : {false, true}) {
    IntrinsicDecomposition::Params none, little;
    none.adaptive = little.adaptive = adaptive;
    none.tolerances.chroma = little.tolerances.chroma = 0;
    none.prior.chroma_weight = 0;
    little.prior.chroma_weight = 1e-9F;
    IntrinsicDecomposition without(device, extent), with(device, extent);
    const PlanePtr in = input(extent, pixels);
    const Pixels got = decompose(without, in, none), want = decompose(with, in, little);
    EXPECT_FALSE(without.stats(0).plan.bins);
    EXPECT_TRUE(has_reason(without.stats(0).plan.skipped, "chroma bins: their weight is 0"));
    EXPECT_TRUE(with.stats(0).plan.bins);
    EXPECT_FALSE(has_reason(with.stats(0).plan.skipped, "chroma bins"));
    EXPECT_LT(shading_distance(got, want), 1e-4);
  }
}

TEST_F(SkipTest, TheEffectOfBinsIsBoundedBeforehand) {
  const Extent extent{64, 48};
  for (const float weight : {1.0F, 0.03F, 0.001F})
    for (const unsigned seed : {1U, 2U, 3U}) {
      const Pixels pixels = seed == 3 ? soft_scene(extent, 0) : scene(extent, seed);
      const PlanePtr in = input(extent, pixels);
      IntrinsicDecomposition::Params with, without;
      with.cycles = without.cycles = 32;
      with.tolerances.cycle = without.tolerances.cycle = 0;
      with.tolerances.chroma = 0;
      with.prior.chroma_weight = weight;
      without.prior.chroma_weight = 0;
      IntrinsicDecomposition one(device, extent), other(device, extent);
      const Pixels bound = decompose(one, in, with), free = decompose(other, in, without);
      const double binding = static_cast<double>(one.findings().binding);
      // The weights of the value prior, one of whose cells is 4 x 4 pixels.
      Guide guide(device, extent);
      EdgePrior prior(device, extent);
      const Extent cells = guide.cell_extent();
      const EdgePrior::Target target{buffer(pack4_count(extent) * 3),
                                     buffer(pack4_count(extent) * 2),
                                     buffer(pack4_count(cells) * 3)};
      run([&](gpu::Commands& commands) {
        guide.record(commands, in->buffer, nullptr);
        prior.record(commands, guide, target, with.prior);
      });
      const Pixels value = download(target.value);
      double sum = 0, weights = 0;
      const auto with_bins = log_shading_of(bound), without_bins = log_shading_of(free);
      for (uint32_t y = 0; y < cells.height; ++y)
        for (uint32_t x = 0; x < cells.width; ++x) {
          double change = 0;
          for (uint32_t k = 0; k < 16; ++k) {
            const size_t pixel = (4 * y + k / 4) * extent.width + 4 * x + k % 4;
            change += with_bins[pixel] - without_bins[pixel];
          }
          const double v = value[packed(cells, x, y, 3)];
          sum += v * change * change / 256;
          weights += v;
        }
      const double moved = std::sqrt(sum / weights);
      EXPECT_LT(moved, 1.02 * binding + 1e-4) << "weight " << weight << " seed " << seed;
      EXPECT_GT(moved, 0.002 * binding) << "weight " << weight << " seed " << seed;
    }
}

TEST_F(SkipTest, APictureWithoutColorsSkipsBins) {
  const Extent extent{160, 120};
  const PlanePtr plain = input(extent, Pixels(extent.pixels() * 4, 0.4F));
  const PlanePtr colored = input(extent, scene(extent, 2));
  IntrinsicDecomposition method(device, extent), whole(device, extent), all(device, extent);
  IntrinsicDecomposition::Params params, always, off;
  always.tolerances.chroma = 0;
  off.adaptive = false;
  int skipped = 0;
  for (int i = 0; i < 16; ++i) {
    const Pixels got = decompose(method, plain, params, false);
    EXPECT_LT(shading_distance(got, decompose(whole, plain, always, false)), 0.005);
    decompose(all, plain, off, false);
    const auto& stats = last_stats(method);
    skipped += !stats.plan.bins;
    EXPECT_EQ(has_reason(stats.plan.skipped, "chroma bins: their effect is below its tolerance"),
              !stats.plan.bins);
    EXPECT_TRUE(last_stats(whole).plan.bins);
    EXPECT_TRUE(last_stats(all).plan.bins);
  }
  EXPECT_GE(skipped, 9);
  EXPECT_LE(skipped, 12) << "now and then it has to look";
  for (int i = 0; i < 8; ++i) decompose(method, colored, params, false);
  for (int i = 0; i < 8; ++i) {
    decompose(method, colored, params, false);
    EXPECT_TRUE(last_stats(method).plan.bins) << "a new scene needs them";
  }
}

TEST_F(SkipTest, PixelsAreNotComparedIfEverythingMoves) {
  const Extent extent{160, 120};
  IntrinsicDecomposition method(device, extent), whole(device, extent);
  IntrinsicDecomposition::Params params, always;
  always.tolerances.gate = 0;
  int skipped = 0;
  for (unsigned i = 0; i < 16; ++i) {  // a cut at every frame
    const PlanePtr in = input(extent, scene(extent, i % 2 ? 4 : 5));
    const Pixels got = decompose(method, in, params, false);
    EXPECT_LT(shading_distance(got, decompose(whole, in, always, false)), 0.01) << "frame " << i;
    const auto& stats = last_stats(method);
    skipped += stats.plan.history && !stats.plan.compares_pixels;
    EXPECT_EQ(has_reason(stats.plan.skipped, "temporal anchor of pixels"),
              stats.plan.history && !stats.plan.compares_pixels);
    EXPECT_EQ(last_stats(whole).plan.compares_pixels, i > 0);
  }
  EXPECT_GE(skipped, 8);
  const PlanePtr still = input(extent, scene(extent, 4));
  for (int i = 0; i < 8; ++i) decompose(method, still, params, false);
  for (int i = 0; i < 4; ++i) {
    decompose(method, still, params, false);
    EXPECT_TRUE(last_stats(method).plan.compares_pixels) << "what stands still is held";
  }
}

TEST_F(SkipTest, AnotherResolutionStartsFromTheFirstsResult) {
  for (const Extent extent : {Extent{160, 120}, Extent{61, 35}, Extent{7, 2}}) {
    const PlanePtr still = input(extent, scene(extent, 6));
    ScaledIntrinsic carried(device, extent), forgets(device, extent);
    ScaledIntrinsic::Params params;
    params.tolerances.half = 0;
    Pixels before[2];
    double largest = 0, max_anew = 0;
    for (int i = 0; i < 40; ++i) {
      const int at = i / 10;  // full, half, a quarter, full
      params.half_resolution = at == 1 || at == 2;
      params.quarter_resolution = at == 2;
      const bool crosses = i > 0 && i % 10 == 0;
      const Pixels now[2] = {frame(carried, still, params), frame(forgets, still, params, crosses)};
      EXPECT_EQ(last_stats(carried).crossed, crosses);
      EXPECT_EQ(last_stats(carried).halvings, at == 3 ? 0U : static_cast<size_t>(at));
      EXPECT_EQ(last_stats(carried).plan.history, i > 0);
      EXPECT_FALSE(carried.findings(carried.recorded() - 1).cut);
      if (crosses) {
        EXPECT_LT(carried.findings(carried.recorded() - 1).mismatch, 1e-4);
      }
      ASSERT_TRUE(all_finite(now[0]));
      if (i >= 10) {
        update_max(largest, shading_distance(now[0], before[0]));
        update_max(max_anew, shading_distance(now[1], before[1]));
        if (crosses) {
          EXPECT_LT(shading_distance(now[0], before[0]), 0.01) << name_of(extent) << " at " << i;
        }
      }
      before[0] = now[0];
      before[1] = now[1];
    }
    std::printf("%s: largest step of log shading %.3f, history forgotten %.3f\n",
                name_of(extent).c_str(), largest, max_anew);
    EXPECT_LT(largest, 0.4 * max_anew) << name_of(extent);
  }
}

TEST_F(SkipTest, HalfResolutionIsChosenWithinItsBound) {
  const Extent extent{160, 120};
  const PlanePtr soft = input(extent, soft_scene(extent, 0)),
                 sharp = input(extent, scene(extent, 4));
  ScaledIntrinsic method(device, extent), full(device, extent), all(device, extent);
  ScaledIntrinsic::Params params, never, off;
  never.tolerances.half = 0;
  off.adaptive = false;
  LayerDistance distance(device, extent);
  const auto step = [&](const PlanePtr& in, uint64_t slot) {
    Layers one, other;
    run([&](gpu::Commands& commands) {
      one = method.record(commands, in, params, {});
      other = full.record(commands, in, never, {});
      all.record(commands, in, off, {});
      distance.record(commands, in->buffer, one[Role::intrinsic]->buffer,
                      other[Role::intrinsic]->buffer, slot);
    });
    EXPECT_EQ(last_stats(full).halvings, 0U);
    EXPECT_EQ(last_stats(all).halvings, 0U);
    return distance.value(slot);
  };
  for (uint64_t i = 0; i < 40; ++i) {
    EXPECT_LT(step(soft, i), params.tolerances.half) << "frame " << i;
    EXPECT_EQ(last_stats(method).compared, i == ResolutionPlanner::kFirst) << "frame " << i;
    EXPECT_EQ(last_stats(method).halvings, i < ResolutionPlanner::kFirst + 3 ? 0U : 1U)
        << "frame " << i;
  }
  const float soft_distance = method.findings(method.recorded() - 1).half_distance;
  EXPECT_GT(soft_distance, 0);
  EXPECT_LT(soft_distance, params.tolerances.half);
  // A cut: compared as soon as it is detected, and given up.
  for (uint64_t i = 0; i < 8; ++i) step(sharp, i);
  float off_by = 0;
  for (uint64_t i = 0; i < 90; ++i) {  // the anchor leads on to what full resolution finds
    off_by = step(sharp, i);
    EXPECT_EQ(last_stats(method).halvings, 0U) << "frame " << i;
  }
  EXPECT_LT(off_by, params.tolerances.half);
  EXPECT_GT(method.findings(method.recorded() - 1).half_distance, params.tolerances.half);
}

TEST_F(SkipTest, DistanceOfLayersIsThatOfTheirShading) {
  for (const Extent extent : kOddSizes) {
    const Pixels pixels = random_pixels(extent, 1), one = random_pixels(extent, 2, 0.1F, 2),
                 other = random_pixels(extent, 3, 0.1F, 2);
    double weights = 0, sum = 0, squares = 0;
    for (size_t i = 0; i < pixels.size(); i += 4) {
      const double light = (static_cast<double>(pixels[i]) + static_cast<double>(pixels[i + 1]) +
                            static_cast<double>(pixels[i + 2])) /
                           3;
      const double w = light / (light + 0.02), d = std::log(static_cast<double>(one[i + 3]) /
                                                            static_cast<double>(other[i + 3]));
      weights += w, sum += w * d, squares += w * d * d;
    }
    const double want = std::sqrt(std::max(squares / weights - sum * sum / weights / weights, 0.0));
    LayerDistance distance(device, extent);
    const Plane frame = plane(extent, pixels), a = plane(extent, one), b = plane(extent, other);
    run([&](gpu::Commands& commands) {
      distance.record(commands, frame.buffer, a.buffer, b.buffer, 1);
      distance.record(commands, frame.buffer, a.buffer, a.buffer, 2);
    });
    EXPECT_NEAR(distance.value(1), want, 1e-3 * want + 1e-6) << name_of(extent);
    EXPECT_NEAR(distance.value(2), 0, 1e-6) << name_of(extent);
  }
}

}  // namespace inverse::testing
