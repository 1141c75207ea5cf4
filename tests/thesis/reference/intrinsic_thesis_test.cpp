// SPDX-License-Identifier: LGPL-2.1-or-later
// The reference itself: is A x − b half the gradient of the energy, do the solvers descend?
#include "intrinsic_thesis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace inverse::reference {
namespace {

Plane random_plane(int width, int height, unsigned seed, double low, double high) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(low, high);
  Plane plane(width, height);
  for (Vec4& pixel : plane.data) {
    for (double& channel : pixel) channel = value(random);
  }
  return plane;
}

/// A checkered picture with a shading ramp: something that a decomposition can find structure in.
Plane checkers(int width, int height) {
  const Vec3 colors[] = {{0.8, 0.3, 0.2}, {0.2, 0.5, 0.7}, {0.6, 0.6, 0.55}};
  Plane plane(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double shading = 0.2 + 0.8 * x / width;
      const Vec3& color = colors[(x / 7 + y / 5) % 3];
      plane.at(x, y) = {color[0] * shading, color[1] * shading, color[2] * shading, 1};
    }
  }
  return plane;
}

/// The energy with its non-local targets held fixed, as the solver sees it within an IRLS step.
double frozen_energy(const ThesisLevel& level, const Plane& x, const Plane& clusters,
                     const SampleFrame& targets, const ThesisParams& params) {
  return thesis_energy(level, x, clusters, {&targets}, 0, 0, params).total();
}

/// Left and right half in strokes of constant shading and constant reflectance, with weights that
/// fall toward the outside, and pixels between that belong to none.
StrokeMask two_strokes(int width, int height) {
  StrokeMask mask{{StrokeKind::shading, StrokeKind::reflectance}, {}, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double depth = std::abs(2.0 * (x + 0.5) / width - 1);
      mask.stroke.push_back(depth < 0.2 ? -1 : 2 * x >= width);
      mask.weight.push_back(depth < 0.2 ? 0 : 1.2 - depth);
    }
  }
  return mask;
}

/// The largest of a stroke's standard deviations, by weight.
double deviation(const StrokeMask& mask, std::size_t stroke, const Plane& x) {
  const std::vector<Vec4> means = stroke_means(mask, x);
  Vec4 squares{};
  double weight = 0;
  for (std::size_t n = 0; n < x.size(); ++n) {
    if (mask.stroke[n] != static_cast<int>(stroke)) continue;
    weight += mask.weight[n];
    for (int c = 0; c < 4; ++c)
      squares[c] += mask.weight[n] * std::pow(x.data[n][c] - means[stroke][c], 2);
  }
  return std::sqrt((mask.kinds[stroke] == StrokeKind::shading
                        ? squares[3]
                        : std::max({squares[0], squares[1], squares[2]})) /
                   weight);
}

}  // namespace

TEST(IntrinsicThesisReference, SystemIsHalfTheGradientOfTheEnergy) {
  for (const double p : {0.3, 0.8, 1.0, 2.0, 0.7}) {
    ThesisParams params{.chapter4 = p == 0.7, .p = p, .epsilon = 0.02};
    params.tau_cc = 2;  // let samples bind in a random picture
    const ThesisLevel level(random_plane(7, 5, 3, 0, 1), params);
    const Plane x = random_plane(7, 5, 4, -2, 1);
    const Plane clusters = random_plane(7, 5, 5, 0.1, 2);
    const SampleFrame targets = make_sample_frame(level, random_plane(7, 5, 6, -2, 1));
    SourcePlane source = draw_samples(level, {&targets}, 0, 0, params);
    double bound = 0;
    for (std::size_t n = 0; n < source.size(); ++n) {
      bound += source.data[n][3];
      for (int c = 0; c < 3; ++c) source.data[n][c] += clusters.data[n][3] * clusters.data[n][c];
      source.data[n][3] += clusters.data[n][3];
    }
    ASSERT_GT(bound, 0);
    const ThesisSystem system = assemble(level, x, source, params);
    Plane product(7, 5);
    apply(system, x, 0, 0, 7, 5, &product);
    for (std::size_t n = 0; n < x.size(); ++n) {
      for (int c = 0; c < 4; ++c) {
        const double step = 1e-5;
        Plane ahead = x;
        Plane behind = x;
        ahead.data[n][c] += step;
        behind.data[n][c] -= step;
        const double numeric = (frozen_energy(level, ahead, clusters, targets, params) -
                                frozen_energy(level, behind, clusters, targets, params)) /
                               (2 * step);
        const double analytic = 2 * (product.data[n][c] - system.b.data[n][c]);
        EXPECT_NEAR(numeric, analytic, 1e-5 * (1 + std::abs(analytic)));
      }
    }
  }
}

TEST(IntrinsicThesisReference, StrokesAddHalfTheGradientOfTheirEnergy) {
  const ThesisParams params;
  const ThesisLevel level(random_plane(7, 5, 3, 0, 1), params);
  const Plane x = random_plane(7, 5, 4, -2, 1);
  const StrokeMask mask = two_strokes(7, 5);
  const std::vector<Vec4> means = stroke_means(mask, x);
  SourcePlane source(7, 5);
  ShadingSource shading;
  add_strokes(mask, means, &source, &shading);
  const ThesisSystem with = assemble(level, x, source, params, shading),
                     without = assemble(level, x, SourcePlane(7, 5), params);
  Plane product(7, 5), product_without(7, 5);
  apply(with, x, 0, 0, 7, 5, &product);
  apply(without, x, 0, 0, 7, 5, &product_without);
  for (std::size_t n = 0; n < x.size(); ++n) {
    for (int c = 0; c < 4; ++c) {
      const double step = 1e-4;
      Plane ahead = x, behind = x;
      ahead.data[n][c] += step;
      behind.data[n][c] -= step;
      const double numeric =
          (user_energy(mask, means, ahead) - user_energy(mask, means, behind)) / (2 * step);
      const double analytic = 2 * (product.data[n][c] - with.b.data[n][c] -
                                   product_without.data[n][c] + without.b.data[n][c]);
      EXPECT_NEAR(numeric, analytic, 1e-6 * (1 + std::abs(analytic)));
      // The auxiliary variables are where the energy is least.
      std::vector<Vec4> other = means;
      other[n % 2][c] += 0.01;
      EXPECT_GE(user_energy(mask, other, x), user_energy(mask, means, x));
    }
  }
}

TEST(IntrinsicThesisReference, StrokesMakeALayerConstant) {
  for (const bool schwarz : {false, true}) {
    IntrinsicThesis method(ThesisParams{.schwarz = schwarz});
    const Plane picture = checkers(64, 48);
    const StrokeMask mask = two_strokes(64, 48);
    const Plane before = method.decompose(picture);
    method.set_strokes(two_strokes(64, 48));
    const Plane after = method.decompose(picture);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_GT(deviation(mask, k, before), 0.1);
      EXPECT_LT(deviation(mask, k, after), 0.02) << schwarz << ", stroke " << k;
    }
    EXPECT_LT(method.energy(after).total(), method.energy(before).total());
  }
}

TEST(IntrinsicThesisReference, WhatIsKnownAddsHalfTheGradientOfItsEnergy) {
  const ThesisParams params{.chapter4 = true};
  const ThesisLevel level(random_plane(7, 5, 3, 0, 1), params);
  const Plane x = random_plane(7, 5, 4, -2, 1), known = random_plane(7, 5, 5, 0, 1);
  SourcePlane source(7, 5);
  add_known(known, 10, &source);
  const ThesisSystem with = assemble(level, x, source, params),
                     without = assemble(level, x, SourcePlane(7, 5), params);
  Plane product(7, 5), product_without(7, 5);
  apply(with, x, 0, 0, 7, 5, &product);
  apply(without, x, 0, 0, 7, 5, &product_without);
  for (std::size_t n = 0; n < x.size(); ++n) {
    for (int c = 0; c < 4; ++c) {
      const double step = 1e-4;
      Plane ahead = x, behind = x;
      ahead.data[n][c] += step;
      behind.data[n][c] -= step;
      const double numeric =
          (stabilization_energy(known, 10, ahead) - stabilization_energy(known, 10, behind)) /
          (2 * step);
      const double analytic = 2 * (product.data[n][c] - with.b.data[n][c] -
                                   product_without.data[n][c] + without.b.data[n][c]);
      EXPECT_NEAR(numeric, analytic, 1e-6 * (1 + std::abs(analytic)));
    }
  }
}

// Where reflectance is known, r starts as that, and stays there.
TEST(IntrinsicThesisReference, WhatIsKnownHoldsReflectance) {
  const Plane picture = checkers(64, 48);
  Plane known(64, 48);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 32; ++x) {
      for (int c = 0; c < 3; ++c)
        known.at(x, y)[c] = std::log(picture.at(x, y)[c] / (0.2 + 0.8 * x / 64)) - 1;
      known.at(x, y)[3] = 1;
    }
  const auto distance = [&](const Plane& x) {
    double sum = 0;
    for (int row = 0; row < 48; ++row)
      for (int column = 0; column < 30; ++column)
        for (int c = 0; c < 3; ++c)
          sum += std::abs(x.at(column, row)[c] - known.at(column, row)[c]) / (48 * 30 * 3);
    return sum;
  };
  // Samples would hold both halves together, nine times as strongly.
  IntrinsicThesis method({.chapter4 = true, .w_clustering = 0, .samples = 0});
  const double before = distance(method.decompose(picture));
  method.set_known(known, 10);
  double start = -1;
  method.set_trace([&](int, int step, const ThesisEnergy& energy) {
    if (step < 0 && start < 0) start = energy.stabilization;
  });
  EXPECT_LT(distance(method.decompose(picture)), 0.1 * before);
  // On the coarsest level what is known is mixed with i/2 only along its border.
  EXPECT_GE(start, 0);
  EXPECT_LT(start, 0.02 * stabilization_energy(known, 10, method.levels()[0].log_image));
}

TEST(IntrinsicThesisReference, CoarseStrokesAreThoseOfMostWeight) {
  // One row: both strokes are around the third coarse pixel, the second with more weight.
  const StrokeMask fine{{StrokeKind::shading, StrokeKind::reflectance},
                        {-1, 0, 0, 0, 1, 1, -1},
                        {0, 1, 1, 0.5, 0.5, 0.5, 0}};
  const StrokeMask coarse = coarse_strokes(fine, 7, 1);
  EXPECT_EQ(coarse.stroke, (std::vector<int>{0, 0, 1, 1}));
  const std::vector<double> weights{0.25, 0.875, 0.375, 0.125};
  for (std::size_t n = 0; n < 4; ++n) EXPECT_NEAR(coarse.weight[n], weights[n], 1e-12);
}

TEST(IntrinsicThesisReference, DiagonalIsThatOfTheOperator) {
  const ThesisParams params;
  const ThesisLevel level(random_plane(6, 4, 1, 0, 1), params);
  SourcePlane source = random_plane(6, 4, 2, 0, 1);
  ShadingSource shading;
  const StrokeMask mask = two_strokes(6, 4);
  add_strokes(mask, stroke_means(mask, source), &source, &shading);
  const ThesisSystem system =
      assemble(level, random_plane(6, 4, 3, -1, 1), source, params, shading);
  for (std::size_t n = 0; n < 24; ++n) {
    for (int c = 0; c < 4; ++c) {
      Plane unit(6, 4);
      Plane column(6, 4);
      unit.data[n][c] = 1;
      apply(system, unit, 0, 0, 6, 4, &column);
      EXPECT_NEAR(column.data[n][c], diagonal(system, n)[c], 1e-12);
    }
  }
}

TEST(IntrinsicThesisReference, OppositeShiftOfTheLayersIsTheNullSpace) {
  const ThesisParams params{.samples = 0};
  const ThesisLevel level(random_plane(9, 8, 1, 0, 1), params);
  const ThesisSystem system =
      assemble(level, random_plane(9, 8, 2, -1, 1), SourcePlane(9, 8), params);
  Plane shift(9, 8);
  Plane product(9, 8);
  for (Vec4& value : shift.data) value = {1, 1, 1, -1};
  apply(system, shift, 0, 0, 9, 8, &product);
  for (const Vec4& value : product.data) {
    for (const double component : value) EXPECT_NEAR(component, 0, 1e-12);
  }
}

TEST(IntrinsicThesisReference, ConjugateGradientsSolveTheSystem) {
  const ThesisParams params{.epsilon = 0.03};
  const ThesisLevel level(checkers(21, 14), params);
  Plane x = random_plane(21, 14, 1, -1, 1);
  const SampleFrame frame = make_sample_frame(level, x);
  const SourcePlane source = draw_samples(level, {&frame}, 0, 0, params);
  const ThesisSystem system = assemble(level, x, source, params);
  ConjugateGradients(21, 14).run(system, 2000, 1e-12, 0, 0, 21, 14, x, &x);
  Plane product(21, 14);
  apply(system, x, 0, 0, 21, 14, &product);
  for (std::size_t n = 0; n < x.size(); ++n) {
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(product.data[n][c], system.b.data[n][c], 1e-8);
  }
}

TEST(IntrinsicThesisReference, ConsistentIrlsNeverRaisesTheEnergyOnALevel) {
  ThesisParams params;
  params.samples = 0;  // lagged samples are not part of the majorizer
  for (const unsigned which : {0U, 1U, 2U, 3U}) {
    const bool schwarz = (which & 1U) != 0, strokes = (which & 2U) != 0;
    params.schwarz = schwarz;
    IntrinsicThesis method(params);
    method.set_clusters(Plane());
    if (strokes) method.set_strokes(two_strokes(90, 70));
    double previous = 0;
    int level_before = -1;
    method.set_trace([&](int level, int, const ThesisEnergy& energy) {
      // Additive blocks may overshoot where they meet; they must not diverge.
      const double slack = schwarz ? 1.02 : 1 + 1e-9;
      if (level == level_before) {
        EXPECT_LE(energy.total(), previous * slack);
      }
      level_before = level;
      previous = energy.total();
    });
    method.decompose(checkers(90, 70));
    EXPECT_EQ(level_before, 0);
  }
}

TEST(IntrinsicThesisReference, EnoughIterationsReachTheConvergedEnergy) {
  ThesisParams params{.samples = 0};
  params.p = 1;  // strictly convex: one minimum
  params.epsilon = 0.03;
  const Plane picture = checkers(40, 30);
  IntrinsicThesis converged(params);
  converged.set_clusters(Plane());
  converged.set_converged(true);
  const double best = converged.energy(converged.decompose(picture)).total();
  double previous = 1e300;
  for (const int irls : {1, 4, 400}) {
    params.irls_iterations = irls;
    IntrinsicThesis method(params);
    method.set_clusters(Plane());
    const double energy = method.energy(method.decompose(picture)).total();
    EXPECT_GE(energy, best * (1 - 1e-6));
    EXPECT_LE(energy, previous);
    previous = energy;
  }
  EXPECT_LE(previous, best * 1.001);
}

TEST(IntrinsicThesisReference, ExtremeInputStaysFinite) {
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 3}, {17, 5}, {1, 40}, {15, 10}}) {
    for (const double fill : {0.0, 1.0, 0.5, 1e4, inf, -inf, nan}) {
      IntrinsicThesis method{ThesisParams()};
      Plane picture(width, height);
      for (Vec4& pixel : picture.data) pixel = {fill, fill, fill, 1};
      picture.data.back()[0] = 1e4;
      for (int frame = 0; frame < 2; ++frame) {
        for (const Vec4& value : method.decompose(picture).data) {
          for (const double component : value) ASSERT_TRUE(std::isfinite(component)) << fill;
        }
      }
    }
  }
}

TEST(IntrinsicThesisReference, HaltonShiftsStayInsideABlock) {
  EXPECT_EQ(schwarz_shift(0), (std::array<int, 2>{0, 0}));
  EXPECT_EQ(schwarz_shift(1), (std::array<int, 2>{8, 5}));
  EXPECT_EQ(schwarz_shift(2), (std::array<int, 2>{4, 10}));
  EXPECT_EQ(schwarz_shift(3), (std::array<int, 2>{12, 1}));
}

TEST(PaletteReference, FindsSeparateColorsAndMergesDuplicates) {
  const Vec3 colors[] = {{0.8, 0.2, 0.2}, {0.2, 0.7, 0.3}, {0.1, 0.1, 0.1}, {0.9, 0.9, 0.9}};
  Plane picture(64, 48);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.01);
  for (std::size_t n = 0; n < picture.size(); ++n) {
    const Vec3& color = colors[n % 4];
    for (int c = 0; c < 3; ++c) picture.data[n][c] = std::log(color[c]) + noise(random);
  }
  Palette palette{PaletteParams()};
  palette.update(picture);
  for (const Vec3& color : colors) {
    const std::vector<Vec3> found = palette.log_colors();
    Vec4 r{std::log(color[0]), std::log(color[1]), std::log(color[2]), 0};
    const Vec3& nearest = found[nearest_color(r, found)];
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(nearest[c], r[c], 0.06);
  }
  EXPECT_LE(palette.log_colors().size(), 6u);  // ten clusters, four colors
}

}  // namespace inverse::reference
