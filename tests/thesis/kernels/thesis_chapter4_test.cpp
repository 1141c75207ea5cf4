// SPDX-License-Identifier: LGPL-2.1-or-later
// The method of chapter 4 on the device: its weights, what is known of the scene, strokes by level.
#include "extreme_frames.hpp"
#include "kernels/image/pyramid.hpp"
#include "thesis_fixture.hpp"

namespace inverse::testing {

class ThesisChapter4Test : public ThesisTest {
 protected:
  static ThesisParams chapter4(ThesisParams::Solver solver = ThesisParams::Solver::pcg) {
    ThesisParams params{.solver = solver};
    set_chapter4(params);
    return params;
  }
  /// Three times the steps of chapter 3 add that much more rounding.
  void SetUp() override {
    ThesisTest::SetUp();
    tolerance_ = 1e-4;
  }
};

TEST_F(ThesisChapter4Test, HasTheIterationsOfTheThesis) {
  const ThesisParams params = chapter4();
  EXPECT_EQ(params.levels, 5);
  EXPECT_EQ(params.irls_iterations, 7);
  EXPECT_EQ(params.pcg_iterations, 7);
}

TEST_F(ThesisChapter4Test, AgreesWithReference) {
  for (const auto solver : {ThesisParams::Solver::pcg, ThesisParams::Solver::schwarz}) {
    for (const Extent extent : kSizes)
      compare(extent, chapter4(solver), {scene(extent, extent.width)});
    compare({67, 49}, chapter4(solver), {random_pixels({67, 49}, 5)});
  }
  ThesisParams frames = chapter4();
  frames.keyframe_spacing = 1;
  compare({40, 30}, frames, {scene({40, 30}, 1), scene({40, 30}, 2, 3), scene({40, 30}, 3, 5)});
}

// Of the frame's size, smaller, and larger; with strokes, and without other sources.
TEST_F(ThesisChapter4Test, WhatIsKnownAgreesWithReference) {
  for (const auto solver : {ThesisParams::Solver::pcg, ThesisParams::Solver::schwarz})
    for (const Extent extent : kSizes)
      for (const bool strokes : {false, true}) {
        known_weight_ = 10;
        known_extent_ = strokes ? Extent{2 * extent.width + 1, extent.height} : half_of(extent);
        strokes_ = strokes;
        compare(extent, chapter4(solver), {scene(extent, 1), scene(extent, 2, 3)});
      }
  known_extent_ = {67, 49};
  ThesisParams alone = chapter4();
  alone.samples = 0;
  compare({67, 49}, alone, {scene({67, 49}, 1), random_pixels({67, 49}, 5)});
  compare({67, 49}, {}, {scene({67, 49}, 1), scene({67, 49}, 2)});  // in the energy of chapter 3
}

TEST_F(ThesisChapter4Test, TargetsOfWhatIsKnownAgreeWithReference) {
  const ThesisParams params;
  for (unsigned seed = 0; const Extent extent : kOddSizes) {
    const Pixels pixels = random_pixels(extent, ++seed, 0, 1.5F);
    ThesisKnownTerm term(device);
    term.set_levels({extent});
    for (const Extent size : {extent, half_of(extent), Extent{2 * extent.width + 1, extent.height}})
      for (const bool extreme : {false, true})
        for (const float valid : {1.0F, 0.0F}) {
          Known known = known_of(Lab(device), size, seed, 10, extreme);
          known.given.valid = upload({valid, 0, 0, 0});
          run([&](gpu::Commands& commands) {
            term.record(commands, &known.given,
                        {.image = upload(pixels),
                         .scale = upload({-1.25F, 1, 0, 0}),
                         .log_floor = params.log_floor,
                         .chroma_floor = params.chroma_floor});
          });
          auto expected = reference::known_targets(to_reference(extent, pixels), known.expected,
                                                   -1.25, to_reference(params));
          if (valid == 0) expected = reference::Plane(expected.width, expected.height);
          expect_near(download(term.targets(0)), expected, 2e-5,
                      name_of(extent) + " by " + name_of(size));
        }
  }
}

TEST_F(ThesisChapter4Test, ReflectanceStaysWhatIsKnown) {
  const Extent extent{64, 48};
  const Plane frame = plane(extent, scene(extent, 4));
  ThesisDecomposition method(device, extent);
  ThesisParams params = chapter4();
  params.samples = 0;  // they hold both sides together, nine times as strongly
  method.set_params(params);
  decompose(method, frame);
  const Pixels first = download(layers_[Role::intrinsic]);
  // The first frame's own reflectance, half as bright on the left; a strip of it is hidden.
  Pixels reflectance, depth, known_depth;
  for (size_t i = 0; i < extent.pixels(); ++i) {
    const size_t x = i % extent.width;
    for (size_t c = 0; c < 3; ++c)
      reflectance.push_back(std::log(std::max(first[4 * i + c], 1e-3F)) - (x < 32 ? 0.7F : 0.0F));
    reflectance.push_back(1);
    known_depth.push_back(1.5F);
    depth.push_back(x >= 12 && x < 20 ? 1.0F : 1.5F);
  }
  const auto scalars = [&](const Pixels& values) {
    return upload(gpu::Element::scalar, values.data(), values.size());
  };
  const KnownReflectance known{extent,         upload(reflectance),  scalars(known_depth),
                               scalars(depth), upload({1, 0, 0, 0}), 10};
  decompose(method, frame, &known);
  const Pixels got = download(layers_[Role::intrinsic]);
  const auto step = [&](size_t from, size_t to) {
    double sum = 0;
    for (size_t y = 0; y < extent.height; ++y)
      for (size_t x = from; x < to; ++x) {
        const size_t n = 4 * (y * extent.width + x);
        sum += std::log(double{got[n]} / double{first[n]});
      }
    return sum / double((to - from) * extent.height);
  };
  EXPECT_NEAR(step(22, 30) - step(34, 64), -0.7, 0.07);
  EXPECT_NEAR(step(2, 10) - step(34, 64), -0.7, 0.07);
}

// Any weights, places and overlaps, at any size.
TEST_F(ThesisChapter4Test, StrokesOfLevelsAgreeWithReference) {
  for (unsigned seed = 0; const Extent extent : kOddSizes) {
    std::mt19937 random(++seed);
    reference::StrokeMask mask{{}, {}, {}};
    ThesisStrokes strokes;
    for (int k = 0; k < 255; ++k) {
      mask.kinds.push_back(reference::StrokeKind::shading);
      strokes.kinds.push_back(ThesisStrokes::Kind::shading);
    }
    const uint32_t pitch = 4 * pack4_count(extent.width);
    Pixels pixels(size_t{pitch} * extent.height);
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x) {
        const int stroke = random() % 3 ? int(x / 2 + y / 3) % 255 : -1;
        const double weight = stroke < 0 ? 0 : double(1 + random() % 256) / 256;
        mask.stroke.push_back(stroke);
        mask.weight.push_back(weight);
        pixels[size_t{y} * pitch + x] = stroke < 0 ? 0.0F : float(stroke + 1 + weight / 2);
      }
    strokes.mask = upload(pixels);
    ThesisStrokeTerm term(device);
    std::vector<Extent> levels{extent};
    for (int n = 0; n < 4; ++n) levels.push_back(half_of(levels.back()));
    term.set_levels(levels);
    term.set(strokes);
    run([&](gpu::Commands& commands) { term.record_levels(commands); });
    // Each from the device's finer one: a sum that is larger by its last bits decides.
    for (size_t n = 1; n < levels.size(); ++n) {
      const Extent fine = levels[n - 1], coarse = levels[n];
      const auto read = [&](size_t level) {
        const uint32_t packs = 4 * pack4_count(levels[level].width);
        reference::StrokeMask result{mask.kinds, {}, {}};
        const Pixels got = download(term.mask(level));
        for (size_t i = 0; i < got.size(); ++i) {
          if (i % packs >= levels[level].width) {
            EXPECT_EQ(got[i], 0) << "padding";
            continue;
          }
          const double value = double{got[i]}, number = std::floor(value);
          result.stroke.push_back(int(number) - 1);
          result.weight.push_back(2 * (value - number));
        }
        return result;
      };
      const auto expected =
          reference::coarse_strokes(read(n - 1), int(fine.width), int(fine.height));
      const auto got = read(n);
      ASSERT_EQ(got.stroke, expected.stroke) << name_of(extent) << ", " << name_of(coarse);
      EXPECT_LT(max_difference(expected.weight, got.weight), 1e-4) << name_of(coarse);
    }
  }
}

TEST_F(ThesisChapter4Test, StrokesReportHowConstantTheyAre) {
  const Extent extent{67, 49};
  ThesisDecomposition method(device, extent);
  method.set_params(chapter4());
  method.set_strokes(device_strokes(extent));
  const auto stats = decompose(method, plane(extent, scene(extent, 1)));
  const auto mask = strokes_on(67, 49);
  const auto x = to_reference(extent, download(method.solution()));
  const auto means = reference::stroke_means(mask, x);
  ASSERT_EQ(stats.strokes.size(), 3U);
  for (size_t k = 0; k < 3; ++k) {
    double squares = 0, weight = 0;
    const bool shading = mask.kinds[k] == reference::StrokeKind::shading;
    for (size_t n = 0; n < x.size(); ++n) {
      if (mask.stroke[n] != int(k)) continue;
      weight += mask.weight[n];
      for (size_t c = shading ? 3 : 0; c < (shading ? 4U : 3U); ++c)
        squares += mask.weight[n] * std::pow(x.data[n][c] - means[k][c], 2) / (shading ? 1 : 3);
    }
    const double expected = weight > 0 ? std::sqrt(squares / weight) : 0;
    EXPECT_NEAR(double{stats.strokes[k]}, expected, 3e-3) << "stroke " << k;
    EXPECT_LT(stats.strokes[k], 0.05) << "stroke " << k;
  }
}

TEST_F(ThesisChapter4Test, ExtremeInputStaysFinite) {
  for (const auto solver : {ThesisParams::Solver::pcg, ThesisParams::Solver::schwarz}) {
    for (const Extent extent : {Extent{1, 1}, Extent{2, 3}, Extent{37, 21}}) {
      ThesisDecomposition method(device, extent);
      method.set_params(chapter4(solver));
      method.set_strokes(device_strokes(extent));
      for (unsigned seed = 0; const Pixels& pixels : extreme_frames(extent)) {
        ++seed;
        const Known known = known_of(Lab(device), extent, seed, seed % 2 ? 10 : 1e3F, true);
        decompose(method, plane(extent, pixels), &known.given);
        ASSERT_TRUE(are_light(download(layers_[Role::intrinsic])))
            << "a frame of " << pixels.back();
      }
    }
  }
}

}  // namespace inverse::testing
