// SPDX-License-Identifier: LGPL-2.1-or-later
// Scenes of one color, of none, of fewer than requested, and indistinguishable base colors: unused
// layers disappear with their cost.
#include <gtest/gtest.h>

#include <cmath>

#include "check.hpp"
#include "pictures.hpp"
#include "tests/update_max.hpp"

namespace inverse::extremes {
namespace {

using Rgb = GlobalThesis::Rgb;
constexpr Extent kExtent{64, 48};

class GlobalLayerCounts : public testing::Test {
 protected:
  static const Lab& lab() {
    static const Lab lab;
    return lab;
  }
  static Pixels gray_picture(unsigned seed) {
    Pixels frame = mosaic(kExtent, seed);
    for (size_t i = 0; i < frame.size(); i += 4) frame[i] = frame[i + 2] = frame[i + 1];
    return frame;
  }
  static double worst_light_off_gray(const Output& got) {
    double worst = 0;
    for (size_t i = 0; i < got.light.size(); i += 4)
      for (size_t c = 0; c < 3; ++c)
        update_max(worst, std::abs(static_cast<double>(got.light[i + c]) - 1));
    return worst;
  }
  static Output with_colors(const std::vector<Rgb>& colors, const Pixels& frame) {
    Method method(lab(), Solver::global_thesis, kExtent);
    GlobalThesisParams params;
    params.steps = 8;  // many parallel layers converge more slowly than few
    params.samples = 0;
    params.refine_rounds = 0;
    method.set(params);
    method.global_thesis().set_base_colors(colors);
    Output got = method.decompose(frame);
    EXPECT_EQ(method.global_thesis_stats().layers, static_cast<int>(colors.size()));
    EXPECT_EQ(got.shares.size(), (colors.size() + 3) / 4);
    const auto wrong = wrong_layers({Solver::global_thesis}, 0, frame, got);
    EXPECT_FALSE(wrong) << *wrong;
    return got;
  }
};

TEST_F(GlobalLayerCounts, OneBaseColorMeansGrayLight) {
  Method method(lab(), Solver::global, kExtent);
  GlobalIntrinsic::Params params;
  params.base_colors = 1;
  method.set(params);
  for (unsigned frame = 0; frame < 4; ++frame) {
    const Pixels picture = mosaic(kExtent, frame / 2);
    const Output got = method.decompose(picture);
    EXPECT_EQ(method.found().colors, 1U);
    EXPECT_EQ(got.colors(), 1U);
    EXPECT_EQ(got.shares.size(), 1U);
    EXPECT_LT(worst_light_off_gray(got), 1e-5) << "one color says nothing of the light's";
    const auto wrong = wrong_layers({Solver::global}, frame, picture, got);
    EXPECT_FALSE(wrong) << *wrong;
  }
}

TEST_F(GlobalLayerCounts, OneClusterOfTheThesisMethod) {
  Method method(lab(), Solver::global_thesis, kExtent);
  method.set(GlobalThesisParams{.clusters = 1});
  for (unsigned frame = 0; frame < 4; ++frame) {
    const Pixels picture = mosaic(kExtent, frame / 2);
    const Output got = method.decompose(picture);
    EXPECT_EQ(method.global_thesis_stats().colors, 1);
    EXPECT_LE(method.global_thesis_stats().layers, 1);
    EXPECT_LE(got.shares.size(), 1U);
    const auto wrong = wrong_layers({Solver::global_thesis}, frame, picture, got);
    EXPECT_FALSE(wrong) << *wrong;
  }
}

TEST_F(GlobalLayerCounts, NoMoreColorsThanTheSceneHas) {
  const Pixels picture = walls(kExtent, {{0.8F, 0.15F, 0.1F}, {0.1F, 0.2F, 0.8F}}, 0);
  for (const Solver solver : kGlobalSolvers) {
    Method method(lab(), solver, kExtent);
    if (solver == Solver::global_thesis) method.set(GlobalThesisParams{.clusters = 16});
    for (int frame = 0; frame < 4; ++frame) {
      const Output got = method.decompose(picture);
      EXPECT_EQ(got.colors(), 2U) << name_of(solver) << ", frame " << frame;
      EXPECT_TRUE(frame < 3 || got.shares.size() == 1) << name_of(solver);
    }
  }
}

TEST_F(GlobalLayerCounts, GrayScenesHaveNoIndirectLayers) {
  for (const Solver solver : kGlobalSolvers) {
    Method method(lab(), solver, kExtent);
    size_t largest = 0;
    for (unsigned frame = 0; frame < 4; ++frame)
      largest = std::max(largest, method.decompose(mosaic(kExtent, 3)).shares.size());
    EXPECT_GE(largest, 2U) << name_of(solver) << ": more than four colors before";
    // The thesis' method is given the cut, as by its element.
    if (solver == Solver::global_thesis) method.reset();
    for (unsigned frame = 0; frame < 14; ++frame) {
      const Output got = method.decompose(gray_picture(frame));
      EXPECT_LT(worst_light_off_gray(got), 1e-5) << name_of(solver) << ", frame " << frame;
      if (solver == Solver::global_thesis) {
        EXPECT_EQ(method.global_thesis_stats().layers, 0);
        EXPECT_TRUE(got.shares.empty());
        EXPECT_EQ(got.colors(), 0U);
      } else {
        EXPECT_EQ(method.found().colors, 0U);
        // What frames in flight may still need is known when they are done.
        EXPECT_TRUE(frame < gpu::kFramesInFlight || got.shares.size() <= 1) << frame;
        EXPECT_TRUE(frame < 12 || got.shares.empty()) << frame;
      }
    }
  }
  EXPECT_LT(GlobalThesis::bytes_per_pixel(0, 5), GlobalThesis::bytes_per_pixel(5, 5) * 3 / 4);
}

TEST_F(GlobalLayerCounts, ParallelLayersShareTheirLight) {
  const Pixels picture = walls(kExtent, {{0.8F, 0.15F, 0.1F}, {0.1F, 0.2F, 0.8F}}, 0);
  const Rgb red{0.8F, 0.15F, 0.1F};
  const Output one = with_colors({red}, picture);
  for (const size_t count : {2, 5, 16}) {
    const Output got = with_colors(std::vector<Rgb>(count, red), picture);
    double apart = 0, model = 0;
    for (size_t i = 0; i < picture.size(); i += 4) {
      for (size_t k = 1; k < count; ++k)
        update_max(apart, std::abs(static_cast<double>(got.shares[k / 4][i + k % 4]) -
                                   static_cast<double>(got.shares[0][i])));
      for (size_t c = 0; c < 3; ++c)
        model += std::pow(
            static_cast<double>(got.intrinsic[i + c] * got.intrinsic[i + 3] * got.light[i + c] -
                                one.intrinsic[i + c] * one.intrinsic[i + 3] * one.light[i + c]),
            2);
    }
    const double rms = std::sqrt(4 * model / static_cast<double>(3 * picture.size()));
    printf("  %zu parallel layers: apart by %.2e, model by rms %.2e\n", count, apart, rms);
    EXPECT_LT(apart, 1e-4) << count;
    EXPECT_LT(rms, 1e-2) << count;
  }
}

TEST_F(GlobalLayerCounts, BlackAndWhiteBaseColors) {
  const Pixels picture = walls(kExtent, {{0.8F, 0.15F, 0.1F}, {0.1F, 0.2F, 0.8F}}, 0);
  const Rgb black{0, 0, 0}, white{1, 1, 1}, red{0.8F, 0.15F, 0.1F}, negative{-1, -2, -3};
  for (const std::vector<Rgb>& colors : std::vector<std::vector<Rgb>>{
           {black}, {white}, {negative}, {black, white}, {red, black, white, white, black}, {}})
    with_colors(colors, picture);
  // Black has no color, and so it is white.
  EXPECT_EQ(with_colors({black}, picture).light, with_colors({white}, picture).light);
}

}  // namespace
}  // namespace inverse::extremes
