// SPDX-License-Identifier: LGPL-2.1-or-later
// The scale of reflectance over a video: against its reference, and its bounds.
#include "kernels/solve/scale_normalization.hpp"

#include <cmath>
#include <functional>
#include <vector>

#include "tests/kernels/gpu_fixture.hpp"
#include "tests/reference/solve/scale_normalization.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {
namespace {

using reference::ScaleCell;
using Light = reference::LightColor;
using State = shaders::solve_scale_update;

/// A plane without borders: smooth paint and light, waves of 6 to 20 cells.
ScaleCell world(double x, double y) {
  const double paint = 0.5 * std::sin(0.61 * x + 0.2 * y) + 0.4 * std::sin(0.83 * y - 0.31 * x + 1);
  const double light = 0.5 * std::sin(0.07 * x) + 0.3 * std::cos(0.09 * y);
  return {paint + light - 1.5, 0.3 * std::sin(0.45 * x + 2), 0.3 * std::cos(0.52 * y + 0.1 * x),
          paint};
}

/// A frame of it.
struct View {
  double x = 0, y = 0;      ///< of its upper left cell
  double brighter = 0;      ///< ln of a factor on all light
  double solver_scale = 0;  ///< added to all log reflectance, as a solver's own scale may be
  double redder = 0;        ///< added to ln R/B
};

class ScaleNormalizationTest : public GpuTest {
 protected:
  static std::vector<ScaleCell> cells_of(Extent extent, const View& view) {
    std::vector<ScaleCell> cells;
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x) {
        ScaleCell cell = world(x + view.x, y + view.y);
        cell[0] += view.brighter;
        cell[3] += view.solver_scale;
        cell[1] += std::sqrt(3.0) / 2 * view.redder / 2;
        cell[2] += 0.75 * view.redder;
        cells.push_back(cell);
      }
    return cells;
  }

  /// SCALE_… on the device, ln c first.
  Pixels record_state(ScaleNormalization& scale, const std::vector<ScaleCell>& cells,
                      const reference::ScaleNormalization::ScaleTarget& target, bool carries,
                      float white_level, const Light& light) {
    std::vector<float> numbers;
    for (const ScaleCell& cell : cells)
      for (const double v : cell) numbers.push_back(static_cast<float>(v));
    const auto uploaded = upload(numbers);
    const auto requested = upload({static_cast<float>(target.offset), target.dark ? 0.0F : 1.0F,
                                   static_cast<float>(target.brightest), 0});
    const auto lit =
        upload({static_cast<float>(light.slope), static_cast<float>(light.reference), 0, 0});
    const auto decided = upload({0, carries ? 1.0F : 0.0F, 0, 0});
    run([&](gpu::Commands& commands) {
      commands.copy(uploaded, scale.cells(), uploaded->bytes());
      scale.record(commands,
                   {requested, decided, ScaleNormalization::History::decided, white_level, lit});
    });
    return download(scale.value());
  }
  float record(ScaleNormalization& scale, const std::vector<ScaleCell>& cells,
               const reference::ScaleNormalization::ScaleTarget& target, bool carries,
               float white_level = 0.9F) {
    return record_state(scale, cells, target, carries, white_level, {})[0];
  }
};

TEST_F(ScaleNormalizationTest, AgreesWithReference) {
  for (const Extent extent : {Extent{120, 67}, Extent{33, 25}, Extent{5, 9}, Extent{1, 1}}) {
    ScaleNormalization scale(device, extent);
    reference::ScaleNormalization expected(static_cast<int>(extent.width),
                                           static_cast<int>(extent.height));
    for (int k = 0; k < 24; ++k) {
      // A pan that gathers speed, light that changes, a cut, a dark frame.
      View view{0.02 * k * k, 0.3 * k, 0.02 * k, 0.01 * k, 0.004 * k};
      const Light light{0.02 * (k % 7), -0.3 + 0.01 * k};
      if (k >= 12) view.x += 500;
      const bool carries = k != 12;
      const reference::ScaleNormalization::ScaleTarget target{-0.2 - 0.03 * k, k == 18, 0.1 * k};
      const float white = k < 20 ? 0.9F : 0.5F;
      const auto cells = cells_of(extent, view);
      const Pixels got = record_state(scale, cells, target, carries, white, light);
      const double want =
          expected.update(cells, target, carries, static_cast<double>(white), light);
      ASSERT_NEAR(got[0], want, 1e-4) << name_of(extent) << ", frame " << k;
      ASSERT_NEAR(got[4 * State::SCALE_LIGHT], expected.exposure(), 1e-4)
          << name_of(extent) << ", frame " << k;
      ASSERT_NEAR(got[4 * State::SCALE_STATE + 3] - got[0] + got[2], expected.white(), 2e-4)
          << name_of(extent) << ", frame " << k;
      if (extent.width > 100 && carries && k > 0 && k != 19) {
        EXPECT_GT(expected.found(), 0.8) << "frame " << k;
      }
    }
  }
}

TEST_F(ScaleNormalizationTest, WhatStaysInViewKeepsItsReflectance) {
  // A solver whose own scale wanders and frames that ask for ever less: neither may show.
  const Extent extent{120, 67};
  const struct {
    const char* name;
    std::function<View(int)> view;
  } shots[] = {{"still",
                [](int k) {
                  return View{0, 0, 0, 0.005 * k};
                }},
               {"pan",
                [](int k) {
                  return View{0.6 * k, 0.2 * k, 0, 0.005 * k};
                }},
               {"shake",
                [](int k) {
                  return View{2 * std::sin(k), std::cos(2 * k), 0, -0.005 * k};
                }},
               {"fade", [](int k) {
                  return View{0.3 * k, 0, -0.02 * k, 0.005 * k};
                }}};
  for (const auto& shot : shots) {
    ScaleNormalization scale(device, extent);
    double first = 0, worst = 0;
    for (int k = 0; k < 60; ++k) {
      const View view = shot.view(k);
      const double brightness = static_cast<double>(record(scale, cells_of(extent, view),
                                                           {-0.1 - 0.01 * k, false}, k > 0)) +
                                view.solver_scale;
      if (k == 0) first = brightness;
      update_max(worst, std::abs(brightness - first));
    }
    EXPECT_LT(worst, 0.02) << shot.name;
  }
}

TEST_F(ScaleNormalizationTest, WhiteLightFollowsTheExposure) {
  // A camera that opens its iris leaves colors as they are; a lamp that is dimmed changes them as
  // shadows do.
  const Extent extent{120, 67};
  const Light light{0.5, -0.5};
  const struct {
    const char* name;
    double redder;   ///< for ln brightness
    double follows;  ///< share of the change that is of the exposure
  } shots[] = {{"exposure", 0, 1}, {"light", light.slope, 0}, {"opposite color", -light.slope, 1}};
  for (const auto& shot : shots) {
    ScaleNormalization scale(device, extent);
    Pixels first, last;
    double brighter = 0;
    for (int k = 0; k < 90; ++k) {
      brighter = 0.7 * std::clamp((k - 10) / 20.0, 0.0, 1.0);
      // As the guide has them: corrected by the color of light of their brightness.
      View view{0.4 * k, 0, brighter, 0, (shot.redder - light.slope) * brighter};
      last = record_state(scale, cells_of(extent, view), {-0.1, false, 0.2}, k > 0, 1.0F, light);
      if (k == 0) first = last;
    }
    const size_t white = 4 * State::SCALE_STATE + 3, exposure = 4 * State::SCALE_LIGHT;
    EXPECT_NEAR(last[exposure] - first[exposure], shot.follows * brighter, 0.02) << shot.name;
    EXPECT_NEAR(last[white] - first[white], shot.follows * brighter, 0.02) << shot.name;
  }
}

TEST_F(ScaleNormalizationTest, ACutAndALostViewGetTheScaleThatTheyAskFor) {
  const Extent extent{120, 67};
  ScaleNormalization scale(device, extent);
  const auto at = [&](double x, double offset, bool carries) {
    return record(scale, cells_of(extent, {x, 0, 0, 0}), {offset, false}, carries, 1.0F);
  };
  EXPECT_FLOAT_EQ(at(0, -0.5, false), -0.5F);
  EXPECT_NEAR(at(0, -1.5, true), -0.5F, 1e-3F);
  EXPECT_FLOAT_EQ(at(900, -1.5, false), -1.5F) << "a cut";
  // Nothing is found again and no cut is reported: a tenth of the way a frame.
  const float before = at(900, -1.5, true);
  EXPECT_NEAR(at(9000.3, -0.5, true), before + 0.1F * (-0.5F - before), 1e-3F);
}

TEST_F(ScaleNormalizationTest, ASceneThatLightsUpGetsItsScale) {
  // A dark first frame gives a bad scale; it must not stay for good.
  const Extent extent{120, 67};
  ScaleNormalization scale(device, extent);
  float last = 0;
  for (int k = 0; k < 60; ++k) {
    auto cells = cells_of(extent, {});
    const size_t lit = cells.size() * static_cast<size_t>(std::min(k + 3, 30)) / 30;
    for (size_t i = lit; i < cells.size(); ++i) cells[i][0] = -6;
    last = record(scale, cells, {k < 3 ? 0.5 : -0.5, false}, k > 0, 1.0F);
  }
  EXPECT_LT(last, -0.2F);
}

TEST_F(ScaleNormalizationTest, BadNumbersDoNotStay) {
  const Extent extent{40, 30};
  ScaleNormalization scale(device, extent);
  const auto good = cells_of(extent, {});
  auto bad = good;
  for (ScaleCell& cell : bad)
    for (double& v : cell) v = kNan;
  record(scale, good, {-0.5, false}, false);
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(std::isfinite(record(scale, bad, {-0.5, false}, true)));
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(record(scale, good, {-0.5, false}, true), std::log(0.9F) - 0.5F, 1e-3F);
}

}  // namespace
}  // namespace inverse::testing
