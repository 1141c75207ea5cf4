// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicdecomp whole, against tests/reference/intrinsic_decomposition.*: stills, videos, bad
// input.
#include <utility>

#include "intrinsic_fixture.hpp"

namespace inverse::testing {

TEST_F(IntrinsicTest, ScaleBringsBrightReflectanceToTheWhiteLevel) {
  const Extent extent{128, 96};
  IntrinsicDecomposition method(device, extent);
  IntrinsicDecomposition::Params params{.cycles = 16, .warm_cycles = 16};
  const auto bright_end = [&](const Pixels& pixels) {
    std::vector<float> brightest;
    for (size_t i = 0; i < pixels.size(); i += 4)
      brightest.push_back(std::max({pixels[i], pixels[i + 1], pixels[i + 2]}));
    std::sort(brightest.begin(), brightest.end());
    return brightest[static_cast<size_t>(params.scale.white_quantile *
                                         static_cast<float>(brightest.size()))];
  };
  Pixels pixels = scene(extent, 4);
  const PlanePtr frame = input(extent, pixels);
  // Counted over cells and here over pixels: near, not equal.
  EXPECT_NEAR(bright_end(decompose_scaled(method, frame, params)), params.scale.white_level, 0.25F);
  const float first = method.findings().scale;
  // Another white level takes effect at once.
  params.scale.white_level = 0.45F;
  decompose_scaled(method, frame, params, false);
  EXPECT_NEAR(method.findings().scale, first - std::log(2.0F), 0.01F);
  decompose_scaled(method, frame, params, true);
  EXPECT_NEAR(method.findings().scale, first - std::log(2.0F), 1e-5F);
  // A black frame asks for no scale: the next one with light does, at once.
  decompose_scaled(method, input(extent, Pixels(pixels.size(), 0.0F)), params, true);
  EXPECT_EQ(method.findings().scale, 0.0F);
  params.scale.white_level = 0.9F;
  decompose_scaled(method, frame, params, false);
  EXPECT_NEAR(method.findings().scale, first, 0.05F);
}

TEST_F(IntrinsicTest, WholeSolveAgreesWithReference) {
  for (const Extent extent : kOddSizes) {
    const Pixels pixels = scene(extent, 1);
    const auto expected = expected_of(extent, pixels).log_shading;
    const Pixels got = decompose(extent, pixels);
    for (size_t i = 0; i < got.size(); ++i)
      if (i % 4 < 3) {
        ASSERT_NEAR(got[i] * got[i | 3], pixels[i], 1e-5) << "R S must be I";
      }
    EXPECT_LT(max_difference(log_shading_of(got), expected), 2e-4) << name_of(extent);
  }
}

TEST_F(IntrinsicTest, ColoredLightAgreesWithReference) {
  for (const Extent extent : kOddSizes)
    for (const float slope : {0.6F, -1.2F, 2.0F}) {
      const Pixels pixels = scene(extent, 1);
      IntrinsicDecomposition method(device, extent);
      SceneLight light(device, extent);
      const PlanePtr frame = input(extent, pixels);
      Layers layers;
      run([&](gpu::Commands& commands) {
        light.record(commands, frame->buffer, {slope}, true);
        layers =
            method.record(commands, frame, {.adaptive = false}, {.reset = true, .light = &light});
      });
      const Pixels carried = download(layers[Role::slope]), got = download(layers[Role::intrinsic]);
      EXPECT_EQ(carried[0], slope);
      const double scale = double(method.findings().scale);
      reference::IntrinsicParams params;
      params.light = {double(slope), double(download(light.state())[1]),
                      double(carried[1]) + scale};
      const auto expected = expected_of(extent, pixels, params);
      double worst = 0;
      for (size_t i = 0; i < extent.pixels(); ++i) {
        const double shading = std::log(double(got[4 * i + 3]));
        const auto color = reference::light_color(params.light, shading - double(carried[1]));
        worst = std::max(worst, std::abs(shading + scale - expected.log_shading[i]));
        for (size_t c = 0; c < 3; ++c)
          ASSERT_NEAR(double(got[4 * i + c] * got[4 * i + 3]) * color[c], pixels[4 * i + c], 1e-5)
              << "reflectance in colored light must be the frame";
      }
      EXPECT_LT(worst, 1e-3) << name_of(extent) << ", slope " << slope;
    }
}

TEST_F(IntrinsicTest, FollowsAVideoAsTheReferenceDoes) {
  const Extent extent{160, 120};
  IntrinsicDecomposition method(device, extent);
  IntrinsicDecomposition::Params params{.cycles = 3, .warm_cycles = 3};
  params.adaptive = false;  // the reference evaluates every edge and all cycles
  reference::IntrinsicState state;
  std::mt19937 random(16);
  std::uniform_real_distribution<float> noise(0, 1);
  for (int time = 0; time < 4; ++time) {
    Pixels pixels = scene(extent, time < 3 ? 6 : 7);  // the last frame is another scene: a cut
    for (size_t i = 0; i < pixels.size(); ++i)
      if (i % 4 < 3)
        pixels[i] *=
            (1 - 0.15F * static_cast<float>(time) * static_cast<float>((i / 4) % extent.width) /
                     static_cast<float>(extent.width)) *
            (0.98F + 0.04F * noise(random));
    const size_t left = 20 + 7 * static_cast<size_t>(time);  // a checkered patch moves over it
    for (size_t y = 40; y < 80; ++y)
      for (size_t x = left; x < left + 40; ++x)
        for (size_t c = 0; c < 3; ++c)
          pixels[4 * (y * extent.width + x) + c] =
              ((x - left) / 5 + y / 5) % 2 == 0 ? 0.1F + 0.1F * static_cast<float>(c) : 0.5F;
    const auto expected = expected_of(extent, pixels, {.cycles = 3}, &state);
    EXPECT_EQ(expected.stats.anchored, time == 1 || time == 2)
        << "the scenes must be what this test takes them for";
    const Pixels got = decompose(method, input(extent, pixels), params, false);
    EXPECT_EQ(last_stats(method).plan.history, time > 0);
    const auto findings = method.findings();
    EXPECT_NEAR(findings.mismatch, expected.stats.mismatch, 1e-3);
    EXPECT_EQ(findings.cut, time == 3);
    EXPECT_NEAR(findings.change, expected.stats.change.back(), 0.02 * expected.stats.change.back());
    EXPECT_LT(rms_difference(log_shading_of(got), expected.log_shading), 5e-4) << "frame " << time;
  }
}

TEST_F(IntrinsicTest, ASuddenChangeOfAFlatFrameIsACut) {
  // Most of the frame is flat and gray in both scenes, so that the mean mismatch is small.
  const Extent extent{160, 120};
  const Pixels scenes[] = {scene(extent, 6), scene(extent, 7)};
  for (const bool sudden : {true, false}) {
    IntrinsicDecomposition method(device, extent);
    IntrinsicDecomposition::Params params{.cycles = 3, .warm_cycles = 3};
    params.adaptive = false;
    reference::IntrinsicState state;
    size_t before = 0;
    for (int time = 0; time < 8; ++time) {
      Pixels pixels(4 * extent.pixels(), 0.3F);
      const size_t shown = time < 6 && (sudden || time % 2 == 0) ? 0 : 1;
      for (size_t y = 0; y < extent.height; ++y)
        for (size_t x = 0; x < 48; ++x)
          for (size_t c = 0; c < 3; ++c)
            pixels[4 * (y * extent.width + x) + c] = scenes[shown][4 * (y * extent.width + x) + c];
      const auto expected = expected_of(extent, pixels, {.cycles = 3}, &state);
      if (time > 0 && shown != std::exchange(before, shown)) {
        EXPECT_GT(expected.stats.mismatch, 0.05);
        EXPECT_LT(expected.stats.mismatch, 0.3);
      }
      const Pixels got = decompose(method, input(extent, pixels), params, false);
      const auto findings = method.findings();
      if (time == 0) continue;
      EXPECT_NEAR(findings.mismatch, expected.stats.mismatch, 1e-3);
      EXPECT_EQ(findings.cut, !expected.stats.anchored) << time;
      EXPECT_EQ(findings.cut, sudden && time == 6) << time << ": one that comes often is none";
      EXPECT_LT(rms_difference(log_shading_of(got), expected.log_shading), 5e-4) << time;
    }
  }
}

TEST_F(IntrinsicTest, EdgesOfStaticTilesAreReused) {
  const Extent extent{349, 287};
  const Pixels still = scene(extent, 15);
  Pixels moved = still;  // 20 x 20 pixels get darker
  for (size_t y = 100; y < 120; ++y)
    for (size_t x = 200; x < 220; ++x)
      for (size_t c = 0; c < 3; ++c) moved[4 * (y * extent.width + x) + c] *= 0.5F;
  IntrinsicDecomposition::Params adaptive, whole;
  whole.adaptive = false;
  adaptive.tolerances.cycle = 0;
  IntrinsicDecomposition one(device, extent), other(device, extent);
  const uint32_t tiles = ((extent.width + 15) / 16) * ((extent.height + 15) / 16);
  const uint32_t expected[] = {tiles, 0, 4, 0};  // with 4 pixels around: 2 x 2 tiles
  for (int time = 0; time < 4; ++time) {
    const PlanePtr frame = input(extent, time < 2 ? still : moved);
    const Pixels got = decompose(one, frame, adaptive, false);
    EXPECT_EQ(one.findings().tiles_evaluated, expected[time]) << "frame " << time;
    const Pixels want = decompose(other, frame, whole, false);
    EXPECT_EQ(other.findings().tiles_evaluated, tiles);
    if (time < 2) {
      EXPECT_EQ(got, want) << "frame " << time;
    }
    EXPECT_LT(shading_distance(got, want), 0.003) << "frame " << time;
  }
  adaptive.prior.shading_weight = 2;
  decompose(one, input(extent, moved), adaptive, false);
  EXPECT_EQ(one.findings().tiles_evaluated, tiles) << "new parameters concern every tile";
}

TEST_F(IntrinsicTest, AResetDiscardsHistoryAndRunsGiveTheSameBits) {
  const Extent extent{349, 287};
  IntrinsicDecomposition method(device, extent);
  const PlanePtr first = input(extent, scene(extent, 8)), second = input(extent, scene(extent, 9));
  const Pixels alone = decompose(method, second);
  decompose(method, first, {}, false);
  EXPECT_EQ(decompose(method, second, {}, true), alone);
  method.reset();
  EXPECT_EQ(decompose(method, second, {}, false), alone);
  EXPECT_FALSE(last_stats(method).plan.history);
}

TEST_F(IntrinsicTest, MirroredFramesHaveMirroredLayers) {
  // Aggregates start at the left, so that even the reference is quite symmetric only at the end of
  // its cycles (tests/extremes/methods/symmetry_test.cpp).
  const Extent extent{160, 120};
  const Pixels pixels = scene(extent, 10);
  Pixels mirrored(pixels.size());
  for (size_t y = 0; y < extent.height; ++y)
    for (size_t x = 0; x < extent.width; ++x)
      std::copy_n(&pixels[4 * (y * extent.width + x)], 4,
                  &mirrored[4 * (y * extent.width + extent.width - 1 - x)]);
  const auto asymmetry = [&](std::vector<double> one, const std::vector<double>& other) {
    for (auto row = one.begin(); row != one.end(); row += extent.width)
      std::reverse(row, row + extent.width);
    return rms_difference(one, other);
  };
  const auto expected = [&](const Pixels& frame) {
    return expected_of(extent, frame, {.cycles = 8}).log_shading;
  };
  const auto got = [&](const Pixels& frame) {
    return log_shading_of(decompose(extent, frame, {.cycles = 8}));
  };
  EXPECT_LT(asymmetry(got(pixels), got(mirrored)),
            0.005 + 1.2 * asymmetry(expected(pixels), expected(mirrored)));
}

TEST_F(IntrinsicTest, FiniteAndExactOnAnything) {
  for (const Extent extent : kOddSizes) {
    const auto constant = [&](float r, float g, float b) {
      Pixels p(extent.pixels() * 4, 1);
      for (size_t i = 0; i < p.size(); i += 4) p[i] = r, p[i + 1] = g, p[i + 2] = b;
      return p;
    };
    std::vector<std::pair<const char*, Pixels>> frames{
        {"black", constant(0, 0, 0)},
        {"white", constant(1, 1, 1)},
        {"blue", constant(0, 0, 1)},
        {"noise", random_pixels(extent, 11)},
        {"faint noise", random_pixels(extent, 12, 0, 1.0F / 255)},
        {"broken", random_pixels(extent, 13, -1, 2)},
        {"checkerboard", constant(0, 0, 0)},
        {"hot pixel", constant(0.01F, 0.01F, 0.01F)}};
    auto& broken = frames[5].second;
    for (size_t i = 0; i < broken.size(); i += 7)
      broken[i] = i % 3 == 0 ? kNan : i % 3 == 1 ? kInf : -kInf;
    for (size_t i = 0; i < extent.pixels(); ++i)
      if ((i % extent.width + i / extent.width) % 2) std::fill_n(&frames[6].second[4 * i], 3, 1.0F);
    frames[7].second[0] = 1e4F;
    IntrinsicDecomposition method(device, extent);
    for (const auto& [name, pixels] : frames) {
      const Pixels got =
          decompose(method, input(extent, pixels), {}, false);  // each after the other, as a video
      for (size_t i = 0; i < got.size(); ++i) {
        ASSERT_TRUE(std::isfinite(got[i])) << name << " " << name_of(extent) << " at " << i;
        ASSERT_TRUE(i % 4 < 3 ? got[i] >= 0 : got[i] > 0)
            << name << " " << name_of(extent) << " at " << i;
        if (i % 4 == 3) continue;
        const float light = pixels[i] > 0 ? (std::isinf(pixels[i]) ? 1 : pixels[i]) : 0;
        ASSERT_NEAR(got[i] * got[i | 3], light, 1e-5F * (1 + light))
            << name << " " << name_of(extent) << " at " << i;
      }
    }
  }
}

TEST_F(IntrinsicTest, ManyCyclesConverge) {
  const Extent extent{160, 120};
  std::vector<std::pair<std::string, Pixels>> frames{{"scene", scene(extent, 16)},
                                                     {"noise", random_pixels(extent, 17)}};
  for (const uint32_t size : {1U, 2U, 3U, 4U, 5U, 8U, 16U, 32U}) {  // mosaics of strong colors
    std::mt19937 random(size);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<float> colors(3 * 4096);
    for (float& c : colors) c = unit(random) < 0.3F ? 0.01F : unit(random);
    Pixels pixels(extent.pixels() * 4, 1);
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x)
        for (uint32_t c = 0; c < 3; ++c)
          pixels[4 * (static_cast<size_t>(y) * extent.width + x) + c] =
              colors[3 * ((x / size * 131 + y / size * 17) % 4096) + c];
    frames.emplace_back("mosaic of " + std::to_string(size), pixels);
  }
  for (const auto& [name, pixels] : frames) {
    std::vector<Pixels> results;
    for (const uint32_t cycles : {16U, 32U, 96U})
      results.push_back(decompose(extent, pixels, {.cycles = cycles}));
    const double early = shading_distance(results[0], results[2]);
    // Slowly on some mosaics, whose strong edges all meet; a solver that diverges grows instead.
    EXPECT_LT(early, 0.2) << name;
    EXPECT_LT(shading_distance(results[1], results[2]), 0.7 * early + 0.002) << name;
  }
}

TEST_F(IntrinsicTest, AbsurdParametersStayFinite) {
  const Extent extent{64, 48};
  const Pixels pixels = scene(extent, 14);
  for (const float factor : {1e-3F, 1e3F})
    for (int which = 0; which < 5; ++which) {
      IntrinsicDecomposition::Params params;
      float* weights[] = {&params.prior.reflectance_weight, &params.prior.shading_weight,
                          &params.prior.value_weight, &params.prior.chroma_weight,
                          &params.anchor.anchor_weight};
      *weights[which] = factor;
      IntrinsicDecomposition method(device, extent);
      for (int frame = 0; frame < 2; ++frame)
        ASSERT_TRUE(all_finite(decompose(method, input(extent, pixels), params, false)))
            << which << " x " << factor;
    }
  EXPECT_TRUE(all_finite(decompose(extent, pixels, {.prior = {.chroma_weight = 0}})));
}

// Skipped cycles must show in the stats, and cost no more than the tolerance
// bounds: a cycle leaves up to 88 % of an error, so eight times what the last one changed.
TEST_F(IntrinsicTest, CyclesEndWhenLittleChanges) {
  constexpr uint32_t kMaxCycles = 16;
  const bool skips = device->variant().conditional;
  const Extent extent{160, 120};
  const PlanePtr still = input(extent, scene(extent, 9));
  IntrinsicDecomposition::Params params, all;
  params.cycles = params.warm_cycles = all.cycles = all.warm_cycles = kMaxCycles;
  all.adaptive = false;
  IntrinsicDecomposition ending(device, extent), full(device, extent);
  const Pixels complete = decompose(full, still, all);
  EXPECT_EQ(full.findings().cycles, kMaxCycles);
  uint32_t smallest_count = kMaxCycles;
  for (const float tolerance : {0.01F, 0.03F, 0.1F}) {
    params.tolerances.cycle = tolerance;
    const Pixels got = decompose(ending, still, params);
    const uint32_t cycles = ending.findings().cycles;
    EXPECT_LT(ending.findings().change, tolerance);
    EXPECT_LE(cycles, smallest_count);
    smallest_count = cycles;
    const double distance = shading_distance(got, complete);
    std::printf("tolerance %g: %u of %u cycles, %.4f from all\n", static_cast<double>(tolerance),
                cycles, kMaxCycles, distance);
    EXPECT_LT(distance, 8 * tolerance);
  }
  EXPECT_LT(smallest_count, skips ? 5 : kMaxCycles + 1);
  // A static scene converges: one cycle a frame.
  params.tolerances.cycle = 0.01F;
  for (int k = 0; k < 12; ++k) decompose(ending, still, params, false);
  EXPECT_EQ(ending.findings().cycles, skips ? 1 : kMaxCycles);
  // 0 asks for all of them.
  params.tolerances.cycle = 0;
  decompose(ending, still, params, false);
  EXPECT_EQ(ending.findings().cycles, kMaxCycles);
}

}  // namespace inverse::testing
