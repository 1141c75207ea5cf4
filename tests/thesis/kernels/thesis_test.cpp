// SPDX-License-Identifier: LGPL-2.1-or-later
// The method of chapter 3 on the device.
#include "extreme_frames.hpp"
#include "tests/expect_error.hpp"
#include "thesis_fixture.hpp"

namespace inverse::testing {

TEST_F(ThesisTest, ConjugateGradientsAgreeWithReference) {
  for (const Extent extent : kSizes) compare(extent, {}, {scene(extent, extent.width)});
}

TEST_F(ThesisTest, SchwarzAgreesWithReference) {
  const ThesisParams params{.solver = ThesisParams::Solver::schwarz};
  for (const Extent extent : kSizes) compare(extent, params, {scene(extent, extent.width)});
}

TEST_F(ThesisTest, StrokesAgreeWithReference) {
  strokes_ = true;
  for (const auto solver : {ThesisParams::Solver::pcg, ThesisParams::Solver::schwarz}) {
    const ThesisParams params{.solver = solver};
    for (const Extent extent : kSizes) compare(extent, params, {scene(extent, extent.width)});
    compare({67, 49}, params, {random_pixels({67, 49}, 5)});
  }
  // Over several frames, without anything else that holds r, and with other levels.
  const Extent extent{131, 95};
  compare(extent, {.keyframe_spacing = 1}, {scene(extent, 1), scene(extent, 2, 3)});
  compare(extent, {.w_non_local = 0, .w_clustering = 0, .levels = 2}, {scene(extent, 1)});
}

TEST_F(ThesisTest, StrokesComeAndGo) {
  const Extent extent{67, 49};
  const Plane frame = plane(extent, scene(extent, 1));
  ThesisDecomposition method(device, extent);
  const auto next = [&] {
    method.reset();
    decompose(method, frame);
    return download(layers_[Role::intrinsic]);
  };
  const Pixels without = next();
  method.set_strokes(device_strokes(extent));
  const Pixels with = next();
  EXPECT_NE(with, without);
  method.set_params({.levels = 2});  // masks of other sizes
  next();
  method.set_params({});
  EXPECT_EQ(next(), with);
  method.set_strokes({});
  EXPECT_EQ(next(), without);
}

TEST_F(ThesisTest, ExtremeInputStaysFiniteWithStrokes) {
  for (const auto solver : {ThesisParams::Solver::pcg, ThesisParams::Solver::schwarz}) {
    for (const Extent extent : {Extent{1, 1}, Extent{2, 3}, Extent{37, 21}}) {
      ThesisDecomposition method(device, extent);
      method.set_params({.solver = solver});
      method.set_strokes(device_strokes(extent));
      for (const Pixels& pixels : extreme_frames(extent)) {
        decompose(method, plane(extent, pixels));
        ASSERT_TRUE(are_light(download(layers_[Role::intrinsic])))
            << "a frame of " << pixels.back();
      }
    }
  }
}

TEST_F(ThesisTest, LargerFrameAgreesWithReference) {
  ThesisParams params{.irls_iterations = 2};
  compare({349, 287}, params, {scene({349, 287}, 1)});
  compare({8192, 16}, params, {scene({8192, 16}, 2)});
  params.solver = ThesisParams::Solver::schwarz;
  compare({349, 287}, params, {scene({349, 287}, 1)});
}

TEST_F(ThesisTest, FullIterationsAgreeOnAPictureWithoutNoise) {
  // Flat patches are the hard case: with p < 1 and a low floor of the IRLS weight the edges inside
  // them hang between on and off, and single precision alone decides (bench/thesis_convergence).
  ThesisParams params{.epsilon = 5e-3f};
  const Extent extent{320, 240};
  for (const auto solver : {ThesisParams::Solver::pcg, ThesisParams::Solver::schwarz}) {
    params.solver = solver;
    compare(extent, params, {scene(extent, 0, 0, 0)});
  }
}

TEST_F(ThesisTest, RandomPixelsAgreeWithReference) {
  for (const auto solver : {ThesisParams::Solver::pcg, ThesisParams::Solver::schwarz}) {
    const ThesisParams params{.solver = solver};
    for (const Extent extent : {Extent{17, 5}, Extent{67, 49}}) {
      compare(extent, params, {random_pixels(extent, 5)});
    }
  }
}

TEST_F(ThesisTest, KeyframesAgreeWithReference) {
  const Extent extent{40, 30};
  std::vector<Pixels> frames;
  for (uint32_t t = 0; t < 9; ++t) frames.push_back(scene(extent, t, t));
  ThesisParams params;
  params.keyframe_spacing = 1;  // the ring goes round within these frames
  compare(extent, params, frames);
  params.keyframe_spacing = 3;
  params.keyframes = 2;
  params.resample = true;
  compare(extent, params, frames);
}

// Device and reference agree, and the solution is another than with defaults: a parameter that both
// ignored would change nothing.
TEST_F(ThesisTest, EveryParameterReachesTheSolution) {
  const Extent extent{33, 21};
  const std::vector<Pixels> frames = {scene(extent, 3), scene(extent, 4, 1)};
  const ThesisParams defaults{.keyframe_spacing = 1};
  compare(extent, defaults, frames);
  const std::vector<double> plain = solution_;
  using Set = void (*)(ThesisParams&);
  const std::pair<const char*, Set> settings[] = {
      {"irls", [](ThesisParams& p) { p.irls = ThesisParams::Irls::printed; }},
      {"p = 1.3", [](ThesisParams& p) { p.p = 1.3f; }},
      {"p = 0", [](ThesisParams& p) { p.p = 0.0f; }},
      {"w_data", [](ThesisParams& p) { p.w_data = 3; }},
      {"w_shading", [](ThesisParams& p) { p.w_shading = 2; }},
      {"w_chromaticity", [](ThesisParams& p) { p.w_chromaticity = 5; }},
      {"w_reflectance", [](ThesisParams& p) { p.w_reflectance = 4; }},
      {"w_intensity", [](ThesisParams& p) { p.w_intensity = 0.3f; }},
      {"w_non_local", [](ThesisParams& p) { p.w_non_local = 0; }},
      {"w_clustering", [](ThesisParams& p) { p.w_clustering = 0; }},
      {"neither", [](ThesisParams& p) { p.w_non_local = 0, p.w_clustering = 0; }},
      {"w_cs", [](ThesisParams& p) { p.w_cs = 0.7f; }},
      {"alpha_cs", [](ThesisParams& p) { p.alpha_cs = 4; }},
      {"alpha_clustering", [](ThesisParams& p) { p.alpha_clustering = 3; }},
      {"samples", [](ThesisParams& p) { p.samples = 20; }},
      {"tau_cc", [](ThesisParams& p) { p.tau_cc = 0.4f; }},
      {"seed", [](ThesisParams& p) { p.seed = 77; }},
      {"keyframes", [](ThesisParams& p) { p.keyframes = 0; }},
      {"resample", [](ThesisParams& p) { p.resample = true; }},
      {"levels", [](ThesisParams& p) { p.levels = 2; }},
      {"irls_iterations", [](ThesisParams& p) { p.irls_iterations = 3; }},
      {"pcg_iterations", [](ThesisParams& p) { p.pcg_iterations = 5; }},
      {"solver", [](ThesisParams& p) { p.solver = ThesisParams::Solver::schwarz; }},
      {"epsilon", [](ThesisParams& p) { p.epsilon = 0.03f; }},
      {"log_floor", [](ThesisParams& p) { p.log_floor = 0.05f; }},
      {"chroma_floor", [](ThesisParams& p) { p.chroma_floor = 0.1f; }},
  };
  for (const auto& [name, set] : settings) {
    SCOPED_TRACE(name);
    ThesisParams params = defaults;
    set(params);
    compare(extent, params, frames);
    ASSERT_EQ(solution_.size(), plain.size());
    const double change = max_difference(plain, solution_);
    EXPECT_GT(change, 30 * worst_ + 1e-4);
    printf("  %s changes r by %.2e\n", name, change);
  }
}

TEST_F(ThesisTest, TermsWithoutWeightAreSkipped) {
  const Extent extent{37, 21};
  const auto skipped = [&](const ThesisParams& params) {
    ThesisDecomposition method(device, extent);
    method.set_params(params);
    std::vector<std::string> reasons;
    for (uint32_t t = 0; t < 3; ++t)
      reasons = decompose(method, plane(extent, scene(extent, t, t))).skipped;
    return reasons;
  };
  using Reasons = std::vector<std::string>;
  ThesisParams params{.keyframe_spacing = 1};
  EXPECT_EQ(skipped(params), Reasons{});
  params.keyframes = 0;
  EXPECT_EQ(skipped(params), Reasons{"keyframes: none so far, or none wanted"});
  params.w_non_local = 0;
  EXPECT_EQ(skipped(params), Reasons{"samples: none, or their weight is 0"});
  params.w_clustering = 0;
  EXPECT_EQ(skipped(params),
            (Reasons{"samples: none, or their weight is 0", "clusters: their weight is 0"}));
}

TEST_F(ThesisTest, ExtremeInputStaysFinite) {
  for (const auto solver : {ThesisParams::Solver::pcg, ThesisParams::Solver::schwarz}) {
    for (const Extent extent : {Extent{1, 1}, Extent{2, 3}, Extent{37, 21}}) {
      ThesisDecomposition method(device, extent);
      method.set_params({.solver = solver});
      for (const Pixels& pixels : extreme_frames(extent)) {
        decompose(method, plane(extent, pixels));
        ASSERT_TRUE(are_light(download(layers_[Role::intrinsic])))
            << "a frame of " << pixels.back();
      }
    }
  }
}

TEST_F(ThesisTest, ExtremeParametersStayFinite) {
  const Extent extent{37, 21};
  Pixels checkers(extent.pixels() * 4);
  for (size_t n = 0; n < extent.pixels(); ++n) {
    for (size_t c = 0; c < 4; ++c) checkers[4 * n + c] = static_cast<float>((n + n / 37) % 2);
  }
  const Plane frame = plane(extent, checkers);
  ThesisDecomposition method(device, extent);
  const float huge = std::numeric_limits<float>::max();
  for (const float p : {-1.0f, 0.0f, 0.5f, 2.0f, 9.0f}) {
    for (const float weight : {-1.0f, 0.0f, 1e-6f, 1e6f, huge}) {
      method.set_params({.w_intensity = weight,
                         .w_reflectance = weight,
                         .w_clustering = weight,
                         .p = p,
                         .epsilon = 0,
                         .log_floor = 0,
                         .chroma_floor = 0,
                         .levels = 1000});
      decompose(method, frame);
      ASSERT_TRUE(all_finite(download(layers_[Role::intrinsic])))
          << "p " << p << ", weight " << weight;
    }
  }
}

TEST_F(ThesisTest, LayersMultiplyToTheInputWhereTheDataTermBinds) {
  const Extent extent{64, 48};
  const Pixels pixels = scene(extent, 2);
  ThesisDecomposition method(device, extent);
  method.set_params({.w_data = 1e5f});
  decompose(method, plane(extent, pixels));
  const Pixels got = download(layers_[Role::intrinsic]);
  double worst = 0;
  for (size_t n = 0; n < extent.pixels(); ++n) {
    for (size_t c = 0; c < 3; ++c) {
      const double model = static_cast<double>(got[4 * n + c]) * got[4 * n + 3];
      const double input = std::max(static_cast<double>(pixels[4 * n + c]), 1e-3);
      update_max(worst, std::abs(model - input));
    }
  }
  EXPECT_LT(worst, 0.02);
}

// Skipped iterations are counted, and cost less than a hundredth of the energy. It may
// come out lower, too: the energy has many minima, and loose first steps pass by some.
TEST_F(ThesisTest, ConjugateGradientsEndWhenTheResidualIsSmall) {
  const Extent extent{96, 72};
  const Plane frame = plane(extent, scene(extent, 5));
  const auto stats_with = [&](float tolerance, int iterations) {
    ThesisParams params{.energy = true};
    params.samples = 0;  // lagged samples and clusters pull the solution past the least energy
    params.w_clustering = 0;
    params.residual_tolerance = tolerance;
    params.pcg_iterations = iterations;
    ThesisDecomposition method(device, extent);
    method.set_params(params);
    return decompose(method, frame);
  };
  const auto all = stats_with(0, 32), fewer = stats_with(0.01f, 32),
             smallest_count = stats_with(0.1f, 32);
  EXPECT_EQ(all.iterations, all.levels * all.irls_iterations * 32);
  if (device->variant().conditional) {
    EXPECT_LT(fewer.iterations, all.iterations);
    EXPECT_LT(smallest_count.iterations, fewer.iterations);
  } else {
    EXPECT_EQ(smallest_count.iterations, all.iterations);
  }
  const double energy = all.energy.back().total();
  std::printf("iterations %d, %d, %d; energy %g, %g, %g\n", all.iterations, fewer.iterations,
              smallest_count.iterations, energy, fewer.energy.back().total(),
              smallest_count.energy.back().total());
  EXPECT_LT(fewer.energy.back().total(), 1.01 * energy);
}

TEST_F(ThesisTest, SameSeedGivesTheSameBits) {
  const Extent extent{67, 49};
  std::vector<Pixels> results;
  for (int repeat = 0; repeat < 2; ++repeat) {
    ThesisDecomposition method(device, extent);
    for (uint32_t t = 0; t < 3; ++t) decompose(method, plane(extent, scene(extent, t, t)));
    results.push_back(download(layers_[Role::intrinsic]));
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST_F(ThesisTest, DividedSampleFramesGiveTheSameBits) {
  const Extent extent{31, 20};
  std::vector<Pixels> results;
  for (const char* slots : {"6", "3", "2", "1"}) {
    setenv("INVERSE_SAMPLE_SLOTS", slots, 1);
    ThesisDecomposition method(device, extent);
    unsetenv("INVERSE_SAMPLE_SLOTS");
    method.set_params({.keyframe_spacing = 1});
    for (uint32_t t = 0; t < 7; ++t) decompose(method, plane(extent, scene(extent, t, t)));
    results.push_back(download(layers_[Role::intrinsic]));
    EXPECT_EQ(results.back(), results.front()) << slots;
  }
  setenv("INVERSE_SAMPLE_SLOTS", "4", 1);
  expect_error(ErrorKind::unsupported, "INVERSE_SAMPLE_SLOTS is 4; set 6, 3, 2 or 1",
               [&] { ThesisDecomposition(device, extent); });
  unsetenv("INVERSE_SAMPLE_SLOTS");
}

TEST_F(ThesisTest, ResetForgetsThePast) {
  const Extent extent{32, 24};
  const Plane first = plane(extent, scene(extent, 1)), second = plane(extent, scene(extent, 9, 11));
  ThesisDecomposition fresh(device, extent), used(device, extent);
  decompose(fresh, second);
  const Pixels expected = download(layers_[Role::intrinsic]);
  decompose(used, first);
  used.reset();
  decompose(used, second);
  EXPECT_EQ(download(layers_[Role::intrinsic]), expected);
}

}  // namespace inverse::testing
