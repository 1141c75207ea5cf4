// SPDX-License-Identifier: LGPL-2.1-or-later
// What the steps of the thesis' global method do to its energy, clusters fixed and nothing
// sampled. The bound of the norms by weighted squares holds everywhere but in the penalty of
// negative light: light that is positive has no weight, and a step may take it below zero. A step
// may so add what the penalty then is, and what the data term, linearized, left out.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pictures.hpp"
#include "tests/update_max.hpp"

namespace inverse::extremes {
namespace {

using Rgb = GlobalThesis::Rgb;
const std::vector<Rgb> kPaints{{0.8F, 0.15F, 0.1F}, {0.15F, 0.6F, 0.2F}, {0.2F, 0.3F, 0.9F}};
constexpr Extent kExtent{61, 43};

/// Of 24 steps.
GlobalThesis::Stats stats_of(const Lab& lab, GlobalThesisParams params, const Pixels& frame) {
  params.refine_rounds = 0;
  params.trace = true;
  params.steps = 24;
  Method method(lab, Solver::global_thesis, kExtent);
  method.set(params);
  method.global_thesis().set_base_colors(kPaints);
  method.decompose(frame);
  EXPECT_EQ(method.global_thesis_stats().energy.size(), 25U);
  return method.global_thesis_stats();
}

/// The largest relative rise by a step, without the penalty that there is after it.
double largest_rise(const std::vector<GlobalThesis::Energy>& energy) {
  double largest = 0;
  for (size_t k = 1; k < energy.size(); ++k) {
    const double penalty = static_cast<double>(energy[k].non_negativity);
    update_max(largest, (energy[k].total() - penalty) / energy[k - 1].total() - 1);
  }
  return largest;
}

struct Setting {
  const char* name;
  GlobalThesisParams params;
};

std::vector<Setting> settings() {
  std::vector<Setting> all{{"defaults", {}}};
  const auto add = [&](const char* name, auto change) {
    all.push_back({name, {}});
    change(all.back().params);
  };
  add("no penalty", [](auto& p) { p.lambda_non_negativity = 0; });
  add("penalty 1e6", [](auto& p) { p.lambda_non_negativity = 1e6F; });
  add("no data term", [](auto& p) { p.lambda_data = 0; });
  add("data term 1e6", [](auto& p) { p.lambda_data = 1e6F; });
  add("p = 0", [](auto& p) { p.p = 0; });
  add("p = 2", [](auto& p) { p.p = 2; });
  add("floors 1e-4", [](auto& p) { p.epsilon = p.epsilon_r = 1e-4F; });
  add("sparsity 1e4", [](auto& p) { p.lambda_i_sparsity = 1e4F; });
  add("smoothness 1e4", [](auto& p) { p.lambda_smoothness = 1e4F; });
  add("2 iterations", [](auto& p) { p.pcg_iterations = 2; });
  add("100 iterations", [](auto& p) { p.pcg_iterations = 100; });
  return all;
}

TEST(GlobalEnergy, FallsAsFarAsTheStepsPromise) {
  const Lab lab;
  const std::pair<const char*, Pixels> pictures[] = {
      {"mosaic", mosaic(kExtent, 1)},
      {"walls", walls(kExtent, {kPaints[0], kPaints[2]}, 0.02F)},
      {"saturated", frame_of({Solver::global_thesis, kExtent.width, kExtent.height, 1, 7,
                              1U << kSaturated | 1U << kColorNoise, 0},
                             0)}};
  for (const auto& [picture, frame] : pictures)
    for (Setting setting : settings()) {
      setting.params.samples = 0;
      const auto energy = stats_of(lab, setting.params, frame).energy;
      const double beyond = largest_rise(energy);
      double worst = 0;
      for (size_t k = 1; k < energy.size(); ++k)
        update_max(worst, energy[k].total() / energy[k - 1].total() - 1);
      printf("  %-10s %-15s %10.4g to %10.4g, a step up by %.1e, beyond the penalty %.1e\n",
             picture, setting.name, energy.front().total(), energy.back().total(), worst, beyond);
      EXPECT_LT(beyond, 1e-6) << picture << ", " << setting.name;
      EXPECT_LE(energy.back().total(), energy.front().total() * (1 + 1e-6))
          << picture << ", " << setting.name;
    }
}

/// Light that spans `decades`: in patches, so that dark ones border on bright ones.
Pixels spanning(Extent extent, float decades, unsigned seed) {
  Pixels pixels = mosaic(extent, seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  float lights[20];
  for (float& light : lights) light = std::pow(10.0F, decades * (unit(random) - 0.5F));
  lights[3] = std::pow(10.0F, 0.5F * decades);
  lights[4] = std::pow(10.0F, -0.5F * decades);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x)
      for (size_t c = 0; c < 3; ++c)
        pixels[4 * (size_t{y} * extent.width + x) + c] *= lights[(x / 17 + 3 * (y / 11)) % 20];
  return pixels;
}

// Where light spans decades, a step's linearization is off by far: steps are shortened then.
TEST(GlobalEnergy, DoesNotRiseWhereLightSpansDecades) {
  const Lab lab;
  const auto hot = [](float value) {
    Pixels frame = walls(kExtent, {kPaints[0], kPaints[2]}, 0.02F);
    for (size_t c = 0; c < 3; ++c) frame[4 * (20 * kExtent.width + 30) + c] = value;
    return frame;
  };
  const std::pair<const char*, Pixels> pictures[] = {{"2 decades", spanning(kExtent, 2, 1)},
                                                     {"4 decades", spanning(kExtent, 4, 2)},
                                                     {"6 decades", spanning(kExtent, 6, 3)},
                                                     {"8 decades", spanning(kExtent, 8, 4)},
                                                     {"hot pixel", hot(1e4F)},
                                                     {"hotter", hot(6e4F)}};
  int rises = 0;  // without
  for (const auto& [picture, frame] : pictures) {
    for (const auto& [samples, search] : {std::pair{0, false}, {0, true}, {9, false}, {9, true}}) {
      const auto stats = stats_of(lab, {.line_search = search, .samples = samples}, frame);
      const auto& energy = stats.energy;
      const double worst = largest_rise(energy);
      printf(
          "  %-10s %d samples, search %d: %10.4g to %10.4g, a step up by %.1e, %d of 24 steps "
          "shortened\n",
          picture, samples, search, energy.front().total(), energy.back().total(), worst,
          stats.shortened);
      if (!search) {
        rises += worst > 0.01;
        continue;
      }
      EXPECT_LT(worst, samples ? 0.05 : 1e-5) << picture;
      EXPECT_LE(energy.back().total(), energy.front().total() * (1 + 1e-6)) << picture;
    }
  }
  EXPECT_GT(rises, 0) << "these pictures do not need it";
}

}  // namespace
}  // namespace inverse::extremes
