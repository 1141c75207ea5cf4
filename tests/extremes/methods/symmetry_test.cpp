// SPDX-License-Identifier: LGPL-2.1-or-later
// Symmetries: a mirrored frame has mirrored layers, brighter light brighter shading, and colors are
// interchangeable.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "pictures.hpp"
#include "tests/extremes/problems/grid_problem.hpp"
#include "tests/update_max.hpp"

namespace inverse::extremes {
namespace {

using Order = std::array<size_t, 3>;
constexpr Order kUnchanged{0, 1, 2};

/// `pixels` with channel order[c] in the place of channel c.
Pixels permuted(const Pixels& pixels, const Order& order) {
  Pixels result = pixels;
  for (size_t i = 0; i < pixels.size(); i += 4)
    for (size_t c = 0; c < 3; ++c) result[i + c] = pixels[i + order[c]];
  return result;
}

/// Light times 2^n.
Pixels brighter(Pixels pixels, int n) {
  for (size_t i = 0; i < pixels.size(); ++i)
    if (i % 4 < 3) pixels[i] = std::ldexp(pixels[i], n);
  return pixels;
}

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

Output mirrored(Extent extent, Output layers, bool vertically) {
  layers.intrinsic = mirrored(extent, layers.intrinsic, vertically);
  if (!layers.light.empty()) layers.light = mirrored(extent, layers.light, vertically);
  for (Pixels& plane : layers.shares) plane = mirrored(extent, plane, vertically);
  return layers;
}

/// A bound, or what is bounded; `amount` is of indirect light, relative.
struct Distance {
  double rms = INFINITY, max = INFINITY, amount = 1e-3;
};

/// Of R, S and light in log units (black counts as 1e-6), of shares as they are.
Distance distance(const Output& one, const Output& other) {
  Distance result{0, 0, 0};
  size_t count = 0;
  const auto add = [&](double d) {
    result.rms += d * d;
    update_max(result.max, std::abs(d));
    ++count;
  };
  const auto add_all = [&](const Pixels& a, const Pixels& b, auto is_log) {
    const auto value = [&](float v, size_t i) {
      const auto number = static_cast<double>(v);
      return is_log(i) ? std::log(std::max(number, 1e-6)) : number;
    };
    for (size_t i = 0; i < a.size(); ++i) add(value(a[i], i) - value(b[i], i));
  };
  EXPECT_EQ(one.light.size(), other.light.size());
  EXPECT_EQ(one.shares.size(), other.shares.size());
  add_all(one.intrinsic, other.intrinsic, [](size_t) { return true; });
  add_all(one.light, other.light, [](size_t i) { return i % 4 < 3; });
  for (size_t n = 0; n < std::min(one.shares.size(), other.shares.size()); ++n)
    add_all(one.shares[n], other.shares[n], [](size_t) { return false; });
  result.rms = std::sqrt(result.rms / static_cast<double>(count));
  return result;
}

/// How a method decomposes a picture, and how near symmetric pictures must be.
struct Variant {
  const char* name;
  Solver solver;
  Extent extent;
  unsigned seed;
  /// Gives the method its parameters, for light times 2^n and channels in another order.
  std::function<void(Method&, int n, const Order& order)> prepare;
  Distance bound;
  Distance across_axes = bound;  ///< of channels in an order that moves the third one
  float light = 1;               ///< of the picture
};
/// Names a test in GoogleTest's output.
void PrintTo(const Variant& variant, std::ostream* out) { *out << variant.name; }

using Rgb = GlobalThesis::Rgb;
const std::vector<Rgb> kPaints{{0.8F, 0.15F, 0.1F}, {0.15F, 0.6F, 0.2F}, {0.2F, 0.3F, 0.9F}};

GlobalIntrinsic::Params converged() {
  GlobalIntrinsic::Params params;
  params.light.slope = 0;  // its axis is that of red and blue
  params.cycles = params.warm_cycles = 32;
  params.tolerances.cycle = 0;
  params.adaptive = false;
  return params;
}

/// Chromaticity and smoothness alone and nothing sampled, as random numbers have no symmetry.
ThesisParams without_samples() {
  const ThesisParams params{.w_clustering = 0, .samples = 0};
  return params;
}

void set_global_thesis(Method& method, GlobalThesisParams params, const Order& order) {
  params.samples = 0;
  params.refine_rounds = 0;
  method.set(params);
  std::vector<Rgb> colors = kPaints;
  for (size_t k = 0; k < colors.size(); ++k)
    for (size_t c = 0; c < 3; ++c) colors[k][c] = kPaints[k][order[c]];
  method.global_thesis().set_base_colors(colors);
}

class Symmetry : public testing::TestWithParam<Variant> {
 protected:
  Output decompose(const Pixels& frame, int n = 0, const Order& order = kUnchanged) {
    const Variant& variant = GetParam();
    Method method(lab_, variant.solver, variant.extent);
    variant.prepare(method, n, order);
    // The gather of globalintrinsic's second frame has the frame's base colors.
    if (variant.solver == Solver::global) method.decompose(frame);
    const Output got =
        is_global(variant.solver) ? method.decompose(frame) : method.decompose_unscaled(frame);
    amount_ = method.found().amount;
    return got;
  }
  void expect_near(const Output& expected, const Output& got, const Distance& bound,
                   const std::string& what, float amount) const {
    const Distance off = distance(expected, got);
    printf("  %s: rms %.2e, max %.2e; amount %.4f to %.4f\n", what.c_str(), off.rms, off.max,
           static_cast<double>(amount), static_cast<double>(amount_));
    EXPECT_LT(off.rms, bound.rms) << what;
    EXPECT_LT(off.max, bound.max) << what;
    EXPECT_NEAR(amount_, amount, bound.amount * static_cast<double>(amount)) << what;
  }
  Pixels picture() const {
    Pixels frame = mosaic(GetParam().extent, GetParam().seed);
    for (size_t i = 0; i < frame.size(); ++i)
      if (i % 4 < 3) frame[i] *= GetParam().light;
    return frame;
  }

  const Lab lab_;
  float amount_ = 0;  // of indirect light, of the last frame
};
class Mirrored : public Symmetry {};
class Brighter : public Symmetry {};
class Permuted : public Symmetry {};

TEST_P(Mirrored, FramesHaveMirroredLayers) {
  const Variant& variant = GetParam();
  const Output base = decompose(picture());
  const float amount = amount_;
  for (const bool vertically : {false, true}) {
    const Output got = decompose(mirrored(variant.extent, picture(), vertically));
    expect_near(base, mirrored(variant.extent, got, vertically), variant.bound,
                vertically ? "vertically" : "horizontally", amount);
  }
}

TEST_P(Brighter, LightIsBrighterShading) {
  const Output base = decompose(picture());
  const float amount = amount_;
  for (const int n : {-2, 1, 2, 4}) {
    // Below, floors change chroma and dark points count less; above, a camera clips.
    if (GetParam().light < 1 ? n != 1 && n != 2 : GetParam().light > 1 && n < 0) continue;
    Output got = decompose(brighter(picture(), n), n);
    for (size_t i = 3; i < got.intrinsic.size(); i += 4)
      got.intrinsic[i] = std::ldexp(got.intrinsic[i], -n);
    expect_near(base, got, GetParam().bound, "2^" + std::to_string(n), amount);
  }
}

TEST_P(Permuted, ChannelsHavePermutedLayers) {
  const Output base = decompose(picture());
  const float amount = amount_;
  Order order = kUnchanged;
  while (std::next_permutation(order.begin(), order.end())) {
    const Output got = decompose(permuted(picture(), order), 0, order);
    Output expected = base;
    expected.intrinsic = permuted(base.intrinsic, order);
    expected.light = permuted(base.light, order);
    // Slots of globalintrinsic go by mass, which bins decide.
    if (GetParam().solver == Solver::global) expected.shares = got.shares;
    expect_near(expected, got, order[2] == 2 ? GetParam().bound : GetParam().across_axes,
                std::to_string(order[0]) + std::to_string(order[1]) + std::to_string(order[2]),
                amount);
  }
}

const Variant kMirrored[] = {
    // 2^k m + 1 pixels: every level of the pyramid takes the mirrored pixels.
    {"pcg",
     Solver::pcg,
     {65, 49},
     1,
     [](Method& method, int, const Order&) { method.set(without_samples()); },
     {INFINITY, 1e-4}},
    // The blocks of the first step are at the origin, and the frame consists of whole ones.
    {"schwarz",
     Solver::schwarz,
     {64, 48},
     2,
     [](Method& method, int, const Order&) {
       ThesisParams params = without_samples();
       params.levels = params.irls_iterations = 1;
       params.pcg_iterations = 32;
       method.set(params);
     },
     {INFINITY, 1e-4}},
    {"multigrid",
     Solver::multigrid,
     {128, 64},
     4,
     [](Method& method, int, const Order&) {
       method.set(IntrinsicDecomposition::Params{.cycles = 32, .tolerances = {.cycle = 0}});
     },
     {1e-3, 1e-2}},
    // Whole points of the grid, of its coarse one and of the multigrid's cells. Sums in another
    // order move the confidence in the amount, and where that is low, as in a mosaic of random
    // colors, the color of bounced light goes with it (kSure; 2e-4 without).
    {"global",
     Solver::global,
     {128, 64},
     4,
     [](Method& method, int, const Order&) { method.set(converged()); },
     {5e-3, 2e-2}},
    {"global_thesis",
     Solver::global_thesis,
     {61, 43},
     4,
     [](Method& method, int, const Order& order) { set_global_thesis(method, {}, order); },
     {1e-4, 1e-2}},
};

const Variant kBrighter[] = {
    // Far above the floors of 0.002 and 0.01 and below the clipping at 1e4.
    {"multigrid",
     Solver::multigrid,
     {96, 64},
     5,
     [](Method& method, int, const Order&) {
       method.set(IntrinsicDecomposition::Params{.tolerances = {.cycle = 0}});
     },
     {INFINITY, 1e-3},
     {},
     512},
    // Far above the floors, where every channel counts as clipped and the amount stays what is
    // typical; and in the range of a camera, where the floor of 0.003 changes chroma.
    {"global",
     Solver::global,
     {96, 64},
     5,
     [](Method& method, int, const Order&) { method.set(converged()); },
     {2e-4, INFINITY, 1e-5},
     {},
     256},
    {"global_of_a_camera",
     Solver::global,
     {96, 64},
     5,
     [](Method& method, int, const Order&) { method.set(converged()); },
     {0.05, INFINITY, 0.1},
     {},
     0.25F},
    // Its terms are squares of the image, sums of light and sums of log reflectance: weights that
    // follow the light make them the same.
    {"global_thesis",
     Solver::global_thesis,
     {61, 43},
     5,
     [](Method& method, int n, const Order& order) {
       GlobalThesisParams params{.log_floor = 1e-4F, .chroma_floor = 1e-4F};
       for (float* weight : {&params.lambda_data, &params.lambda_monochrome})
         *weight = std::ldexp(*weight, -2 * n);
       for (float* weight :
            {&params.lambda_i_sparsity, &params.lambda_smoothness, &params.lambda_non_negativity})
         *weight = std::ldexp(*weight, -n);
       for (float* floor : {&params.epsilon, &params.chroma_floor, &params.log_floor})
         *floor = std::ldexp(*floor, n);
       set_global_thesis(method, params, order);
     },
     {INFINITY, 1e-4}},
};

// The data term of chapter 3 weighs channels by their luminance; without it all are equal.
void set_without_data(Method& method, int, const Order&) {
  ThesisParams params = without_samples();
  params.w_data = 0;
  method.set(params);
}

const Variant kPermuted[] = {
    {"multigrid",
     Solver::multigrid,
     {96, 64},
     6,
     [](Method& method, int, const Order&) {
       IntrinsicDecomposition::Params params;
       params.prior.chroma_weight = 0;  // the grid of bins has axes
       params.tolerances.cycle = 0;
       method.set(params);
     },
     {INFINITY, 1e-3}},
    {"pcg", Solver::pcg, {65, 49}, 7, set_without_data, {INFINITY, 1e-4}},
    {"schwarz", Solver::schwarz, {65, 49}, 7, set_without_data, {INFINITY, 1e-4}},
    // The histograms whose sharpness decides on the amount have axes, too.
    {"global",
     Solver::global,
     {96, 64},
     6,
     [](Method& method, int, const Order&) {
       auto params = converged();
       params.prior.chroma_weight = 0;
       method.set(params);
     },
     {1e-5, INFINITY, 1e-5},
     {0.03, INFINITY, 0.12}},
    {"global_thesis",
     Solver::global_thesis,
     {61, 43},
     7,
     [](Method& method, int, const Order& order) { set_global_thesis(method, {}, order); },
     {1e-4, 1e-2}},
};

constexpr auto kName = [](const auto& info) { return std::string(info.param.name); };
INSTANTIATE_TEST_SUITE_P(All, Mirrored, testing::ValuesIn(kMirrored), kName);
INSTANTIATE_TEST_SUITE_P(All, Brighter, testing::ValuesIn(kBrighter), kName);
INSTANTIATE_TEST_SUITE_P(All, Permuted, testing::ValuesIn(kPermuted), kName);

TEST(Symmetry, MirroredSystemsHaveMirroredSolutions) {
  const Lab lab;
  // The multigrid's cells and aggregates start at the left: widths of 4 · 2^k are their own mirror
  // images.
  const Extent extent{64, 32};
  GridSystem system(extent), mirror(extent);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> exponent(-0.5, 0.5), unit(-0.5, 0.5);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const uint32_t there = extent.width - 1 - x;
      const float right = std::pow(10.0F, exponent(random));
      system.right[system.at(x, y)] = right;
      if (there > 0) mirror.right[mirror.at(there - 1, y)] = right;
      mirror.down[mirror.at(there, y)] = system.down[system.at(x, y)] =
          std::pow(10.0F, exponent(random));
      mirror.f[mirror.at(there, y)] = system.f[system.at(x, y)] = unit(random);
      mirror.screen[mirror.cell(there, y)] = system.screen[system.cell(x, y)] = 1;
    }
  const auto one = cycles_on_device(lab, system, 60).back();
  const auto other = cycles_on_device(lab, mirror, 60).back();
  double difference = 0, largest = 0;
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      update_max(difference,
                 std::abs(one[system.at(x, y)] - other[system.at(extent.width - 1 - x, y)]));
      update_max(largest, std::abs(one[system.at(x, y)]));
    }
  EXPECT_LT(difference, 1e-5 * largest);
}

}  // namespace
}  // namespace inverse::extremes
