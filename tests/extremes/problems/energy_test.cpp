// SPDX-License-Identifier: LGPL-2.1-or-later
// The energy of the thesis' method along IRLS, on one level, with samples and clusters frozen. A
// consistent weight makes a step's system half the gradient of a bound of the energy. Conjugate
// gradients only go down in it; so do additive blocks without overlap, each from the same start:
// the graph of blocks has two colors, so that what couples two blocks is at most what they gain.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "thesis_problem.hpp"

namespace inverse::extremes {
namespace {

using reference::Plane;
using reference::ThesisParams;

/// Paints in patches, a light with a border, noise; everything that a float holds.
Plane picture(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  double paints[8][3];
  for (auto& paint : paints)
    for (double& channel : paint) channel = 0.03 + 0.9 * unit(random);
  Plane image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (size_t c = 0; c < 3; ++c)
        image.at(x, y)[c] = (x + 2 * y > width ? 0.9 : 0.3) * paints[(x / 6 + y / 4 * 3) % 8][c] *
                            (0.97 + 0.06 * unit(random));
  return in_single_precision(image);
}

/// Whatever a level is solved with besides itself, frozen: samples of a start and clusters.
struct Frozen {
  reference::SampleFrame targets;
  Plane clusters;
  reference::SourcePlane sources;
};
Frozen freeze(const reference::ThesisLevel& level, const Plane& start, const ThesisParams& params) {
  Frozen frozen{make_sample_frame(level, start), Plane(start.width, start.height), {}};
  for (size_t n = 0; n < start.size(); ++n) {
    // A pixel's cluster: its own reflectance, coarsely rounded.
    for (size_t c = 0; c < 3; ++c)
      frozen.clusters.data[n][c] = std::round(2 * start.data[n][c]) / 2;
    frozen.clusters.data[n][3] = params.w_clustering;
  }
  frozen.sources = draw_samples(level, {&frozen.targets}, 0, 0, params);
  for (size_t n = 0; n < start.size(); ++n) {
    for (size_t c = 0; c < 3; ++c)
      frozen.sources.data[n][c] += params.w_clustering * frozen.clusters.data[n][c];
    frozen.sources.data[n][3] += params.w_clustering;
  }
  return frozen;
}

/// Steps of IRLS; fails where one of them raises the energy beyond what rounding does to it.
void descend(const std::string& name, ThesisParams params, const Lab& lab, bool schwarz,
             int iterations) {
  const Plane image = picture(45, 34, 7);
  const reference::ThesisLevel level(image, params);
  Plane x = level.log_image;
  for (reference::Vec4& value : x.data) {
    value[3] = (value[0] + value[1] + value[2]) / 6;
    for (size_t c = 0; c < 3; ++c) value[c] /= 2;
  }
  x = in_single_precision(x);
  const Frozen frozen = freeze(level, x, params);
  const auto energy = [&](const Plane& at) {
    return thesis_energy(level, at, frozen.clusters, {&frozen.targets}, 0, 0, params).total();
  };
  ThesisLab method(lab, image, params);
  method.set_up();
  method.set_sources(frozen.sources);
  method.set_solution(x);
  const double first = energy(x);
  double before = first;
  for (int step = 0; step < 10; ++step) {
    method.step(schwarz, iterations, step);
    const double after = energy(method.solution());
    ASSERT_TRUE(std::isfinite(after)) << name;
    EXPECT_LE(after, before * (1 + 1e-6) + 0x1p-24 * first)
        << name << ", " << iterations << " iterations, step " << step;
    before = after;
  }
  EXPECT_LT(before, first) << name;
}

class Energy : public testing::TestWithParam<Solver> {};

TEST_P(Energy, DoesNotRiseWithinALevel) {
  const Lab lab;
  const bool schwarz = GetParam() == Solver::schwarz;
  using Set = void (*)(ThesisParams&);
  const std::pair<const char*, Set> settings[] = {
      {"defaults", [](ThesisParams&) {}},
      {"no samples, no clusters", [](ThesisParams& p) { p.samples = 0, p.w_clustering = 0; }},
      {"epsilon 1e-6", [](ThesisParams& p) { p.epsilon = 1e-6; }},
      {"p 0.01", [](ThesisParams& p) { p.p = 0.01; }},
      {"p 1, epsilon 1e-6", [](ThesisParams& p) { p.p = 1, p.epsilon = 1e-6; }},
      {"p 1.9", [](ThesisParams& p) { p.p = 1.9; }},
      {"reflectance 1e6", [](ThesisParams& p) { p.w_reflectance = 1e6; }},
      {"shading 1e6", [](ThesisParams& p) { p.w_shading = 1e6; }},
      {"data 1e6", [](ThesisParams& p) { p.w_data = 1e6; }},
      {"chromaticity 1e6, data 1e-6",
       [](ThesisParams& p) { p.w_chromaticity = 1e6, p.w_data = 1e-6; }},
      {"clusters 1e5", [](ThesisParams& p) { p.w_clustering = 1e5; }},
      {"no data", [](ThesisParams& p) { p.w_data = 0; }},
  };
  for (const auto& [name, set] : settings)
    for (const int iterations : {1, 8, 100}) {
      ThesisParams params;
      set(params);
      descend(name, params, lab, schwarz, iterations);
    }
}

INSTANTIATE_TEST_SUITE_P(All, Energy, testing::Values(Solver::pcg, Solver::schwarz), solver_name);

}  // namespace
}  // namespace inverse::extremes
