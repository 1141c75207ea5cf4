// SPDX-License-Identifier: LGPL-2.1-or-later
// Selections against tests/reference/edit/selection/*, and what they find.
#include "kernels/edit/selection/selection.hpp"

#include "tests/kernels/gpu_fixture.hpp"
#include "tests/reference/edit/selection/matte.hpp"
#include "tests/reference/edit/selection/object.hpp"

namespace inverse::testing {
namespace {

using Point = SelectionStroke::Point;
using reference::MatteSpec;

std::vector<reference::Vec3> colors_of(const reference::Plane& reflectance, int side) {
  std::vector<reference::Vec3> colors;
  for (const auto& mean : reference::cell_means(reflectance, side).data)
    colors.push_back(reference::oklab({mean[0], mean[1], mean[2]}));
  return colors;
}

/// What kernels make of numbers that are not finite, or negative (finite.glsl).
Pixels made_finite(Pixels pixels) {
  for (float& v : pixels) v = v > 0 ? std::min(v, 65504.F) : 0;
  return pixels;
}

/// A surface of one paint, with a disc whose paint fades from red to a pale pink from its center to
/// its border, another disc of the same red, and noise.
Pixels discs(Extent extent, Point center, unsigned seed) {
  Pixels pixels = random_pixels(extent, seed, -.02F, .02F);
  const auto size = static_cast<float>(extent.height);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      float* pixel = &pixels[4 * (size_t{y} * extent.width + x)];
      const float d = std::hypot(float(x) + .5F - center[0], float(y) + .5F - center[1]) / size,
                  other =
                      std::hypot(float(x) + .5F - 1.5F * size, float(y) + .5F - .2F * size) / size;
      std::array<float, 3> paint{.12F, .3F, .2F};
      if (other < .1F) paint = {.6F, .06F, .05F};
      if (d < .25F) paint = {.6F + .8F * d, .06F + 1.6F * d, .05F + 1.6F * d};
      for (size_t c = 0; c < 3; ++c) pixel[c] = std::max(paint[c] * (1 + pixel[c]), 0.F);
      pixel[3] = 1;
    }
  return pixels;
}

class SelectionTest : public GpuTest {
 protected:
  Layers layers(Extent extent, const Pixels& frame, const Pixels& reflectance) {
    Layers result;
    result.extent = extent;
    result[Role::input] = shared_plane(extent, frame);
    result[Role::model] = result[Role::intrinsic] = shared_plane(extent, reflectance);
    return result;
  }
  Pixels select(Selection& selection, Layers& frame, const SelectionParams& params,
                const std::vector<SelectionStroke>& strokes = {}, bool restart = false) {
    run([&](gpu::Commands& commands) {
      selection.record(commands, frame, params, {strokes, frame.extent, restart}, nullptr);
    });
    return download(frame[Role::mask]);
  }
};

/// Share of pixels of a mask that are selected but should not be, or the other way around.
template <typename Inside>
double wrong_share(const Pixels& mask, Extent extent, Inside inside) {
  size_t wrong = 0;
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x)
      wrong += (mask[4 * (size_t{y} * extent.width + x)] > .5F) !=
               inside(float(x) + .5F, float(y) + .5F);
  return double(wrong) / double(extent.pixels());
}

}  // namespace

TEST(SelectionSeeds, CoverWhatIsUnderAndInsideOfStrokes) {
  const CellGrid grid({640, 480});
  ASSERT_EQ(grid.side, 2U);
  ASSERT_EQ(grid.cells.width, 320U);
  const auto count = [&](const std::vector<SelectionStroke>& strokes, uint32_t what) {
    const auto seeds = draw_seeds(strokes, grid.frame, grid);
    return std::count(seeds.begin(), seeds.end(), what);
  };
  EXPECT_GE(count({{.points = {{100, 100}}, .radius = 1}}, 1), 1);
  EXPECT_NEAR(count({{.points = {{100, 100}}, .radius = 20}}, 1), 3.1416 * 21 * 21 / 4, 20);
  EXPECT_NEAR(
      count({{.closed = true, .points = {{100, 100}, {300, 100}, {300, 200}, {100, 200}}}}, 1),
      102 * 52 - 4, 4);
  EXPECT_EQ(count({{.points = {{100, 100}}}, {.subtract = true, .points = {{100, 100}}}}, 1), 0);
  EXPECT_EQ(count({}, 1), 0);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(
      count({{.points = {{kNan, 3}, {4, kNan}}}, {.points = {{-1e30F, 1e30F}}}, {.points = {}}}, 1),
      0);
  EXPECT_EQ(
      count({{.closed = true, .points = {{kNan, 3}, {4, 9}, {1e30F, -1e30F}}, .radius = 1}}, 2), 0);
  const CellGrid large({7680, 4320}), small({1, 1});
  EXPECT_EQ(large.cells.width, 240U);
  EXPECT_EQ(small.cells.pixels(), 1U);
}

TEST(SelectionSeeds, CountsWhatLaterStrokesTake) {
  const CellGrid grid({160, 120});
  const auto cells_of = [&](const std::vector<SelectionStroke>& strokes) {
    std::vector<SeedCells> cells;
    draw_seeds(strokes, grid.frame, grid, &cells);
    return cells;
  };
  const SelectionStroke add{.points = {{50, 60}}}, subtract{.subtract = true, .points = {{50, 60}}},
      outside{.points = {{5000, 5000}}}, beside{.subtract = true, .points = {{55, 60}}};
  const auto same = cells_of({add, subtract, outside});
  EXPECT_NEAR(same[0].covered, 3.1416 * 6.5 * 6.5, 20);
  EXPECT_EQ(same[0].taken, same[0].covered);
  EXPECT_EQ(same[1].covered, same[0].covered);
  EXPECT_EQ(same[1].taken, 0U);
  EXPECT_EQ(same[2].covered, 0U);
  const auto part = cells_of({add, add, beside});
  EXPECT_GT(part[0].taken, 0U);
  EXPECT_LT(part[0].taken, part[0].covered);
  EXPECT_EQ(part[1].covered, part[0].covered);
  EXPECT_EQ(part[1].taken, 0U) << "the first of its kind has them";
}

TEST_F(SelectionTest, ObjectAgreesWithReference) {
  for (const Extent extent : {Extent{160, 120}, {700, 90}, {33, 1}, {1, 40}, {17, 5}, {1, 1}}) {
    const CellGrid grid(extent);
    Selection selection(device, extent);
    reference::ObjectSelection expected(int(grid.cells.width), int(grid.cells.height));
    const auto w = float(extent.width), h = float(extent.height);
    for (int n = 0; n < 7; ++n) {
      const float x = n < 5 ? .3F + .02F * float(n) : .7F;
      const Pixels pixels = discs(extent, {x * w, .5F * h}, unsigned(n));
      Layers frame = layers(extent, pixels, pixels);
      std::vector<SelectionStroke> strokes;
      if (n == 0) strokes = {{.points = {{.3F * w, .5F * h}}, .radius = 3}};
      if (n == 2)
        strokes = {
            {.subtract = true, .points = {{.35F * w, .5F * h}, {.4F * w, .6F * h}}, .radius = 2}};
      if (n == 3 || n == 5) {
        run([&](gpu::Commands& commands) { selection.lose(commands); });
        expected.lose();
      }
      const Pixels mask = select(selection, frame, {}, strokes);
      const auto colors = colors_of(to_reference(extent, pixels), int(grid.side));
      if (strokes.empty())
        expected.follow(colors);
      else
        expected.select(colors, draw_seeds(strokes, extent, grid), false);
      // Comparisons with thresholds may turn out differently in single precision, in few cells.
      const auto regions = gpu::Buffer::create(device, gpu::Element::word, grid.cells.pixels(),
                                               gpu::Memory::readback);
      run([&](gpu::Commands& commands) {
        commands.copy(selection.object()->region(), regions, regions->bytes());
      });
      size_t differ = 0;
      for (size_t i = 0; i < expected.region.size(); ++i)
        differ += regions->map_as<uint32_t>()[i] != expected.region[i];
      EXPECT_LE(double(differ), .002 * double(expected.region.size()))
          << name_of(extent) << ", frame " << n;
      const Pixels alpha = download(selection.object()->alpha());
      double apart = 0;
      for (size_t i = 0; i < alpha.size(); ++i)
        apart += std::abs(double(alpha[i]) - expected.alpha[i]);
      EXPECT_LE(apart / double(alpha.size()), 2e-3) << name_of(extent) << ", frame " << n;
    }
  }
}

TEST_F(SelectionTest, MatteAgreesWithReference) {
  for (const Extent extent : {Extent{97, 61}, {700, 43}, {1, 1}, {2, 3}, {40, 1}})
    for (const bool extreme : {false, true}) {
      const CellGrid grid(extent);
      Pixels frame = discs(extent, {.4F * float(extent.width), .5F * float(extent.height)}, 3),
             paint = random_pixels(extent, 4),
             chosen = discs(extent, {.4F * float(extent.width), .5F * float(extent.height)}, 5);
      // A selection of the disc, soft by noise.
      for (size_t i = 0; i < extent.pixels(); ++i)
        chosen[4 * i] = std::clamp(4 * (chosen[4 * i] - .4F), 0.F, 1.F);
      Pixels before = random_pixels(extent, 6, -.5F, 1.2F);
      for (size_t i = 0; i < extent.pixels(); ++i) before[4 * i] = std::max(before[4 * i], 0.F);
      if (extreme)
        for (Pixels* pixels : {&frame, &paint, &chosen}) {
          std::mt19937 random(7);
          constexpr float kOdd[] = {0, -1, 1e-30F, 65504, kInf, kNan, 1e30F, 1e-5F};
          for (float& v : *pixels)
            if (random() % 9 == 0) v = kOdd[random() % std::size(kOdd)];
        }
      const auto plane_of = [&](const Pixels& pixels) {
        return to_reference(extent, made_finite(pixels));
      };
      const reference::Plane selection = plane_of(chosen), mask = to_reference(extent, before);
      const auto region = reference::covered_cells(selection, int(grid.side));
      Matte matte(device, grid);
      for (const bool soft : {true, false})
        for (const bool invert : {false, true})
          for (const Combine combine :
               {Combine::replace, Combine::add, Combine::subtract, Combine::intersect}) {
            Layers layered = layers(extent, frame, paint);
            layered[Role::mask] = shared_plane(extent, before);
            const Plane picture = plane(extent, chosen);
            const auto light = buffer(grid.cells.pixels()), colors = buffer(grid.cells.pixels());
            const gpu::Program<shaders::edit_selection_cells> cells(device, {.colors = false});
            run([&](gpu::Commands& commands) {
              commands.dispatch(cells,
                                {.reflectance = layered[Role::model]->buffer,
                                 .frame = layered[Role::input]->buffer,
                                 .light = light,
                                 .colors = colors},
                                {.size = extent, .cells = grid.cells, .side = grid.side},
                                {grid.cells.width, grid.cells.height});
              matte.record(commands, layered, light, picture, {combine, invert, soft});
            });
            const auto expected = reference::matte(
                plane_of(frame), plane_of(paint), int(grid.side), {}, region, &selection, &mask,
                {soft, invert, static_cast<decltype(MatteSpec::combine)>(combine)});
            ASSERT_NO_FATAL_FAILURE(expect_near(
                download(layered[Role::mask]), expected, extreme ? 3e-3 : 1e-3,
                name_of(extent) + (soft ? " soft" : " hard") + (invert ? " inverted" : "") +
                    " combined " + std::to_string(int(combine))));
          }
    }
}

TEST_F(SelectionTest, AClickSelectsTheWholeObjectAndFollowsIt) {
  const Extent extent{320, 240};
  Selection selection(device, extent);
  for (int n = 0; n < 30; ++n) {
    const Point center{80 + 4 * float(n), 120 + 20 * std::sin(float(n) / 5)};
    const Pixels pixels = discs(extent, center, unsigned(n));
    Layers frame = layers(extent, pixels, pixels);
    std::vector<SelectionStroke> strokes;
    if (n == 0) strokes = {{.points = {center}}};
    const Pixels mask = select(selection, frame, {}, strokes);
    EXPECT_LT(wrong_share(
                  mask, extent,
                  [&](float x, float y) { return std::hypot(x - center[0], y - center[1]) < 60; }),
              .004)
        << "frame " << n;
  }
}

TEST_F(SelectionTest, WhatIsSubtractedStaysSubtracted) {
  // Two bars of different paint; both are added, then one of them is subtracted.
  const Extent extent{160, 120};
  const auto bars = [&](unsigned seed) {
    Pixels pixels = random_pixels(extent, seed, .97F, 1.03F);
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x) {
        const float wall[] = {.3F, .35F, .4F}, red[] = {.6F, .08F, .06F},
                    yellow[] = {.7F, .6F, .1F};
        const bool inside = y > 30 && y < 90;
        const float* paint = inside && x > 30 && x < 60    ? red
                             : inside && x > 90 && x < 120 ? yellow
                                                           : wall;
        for (size_t c = 0; c < 3; ++c) pixels[4 * (size_t{y} * extent.width + x) + c] *= paint[c];
      }
    return pixels;
  };
  Selection selection(device, extent);
  for (unsigned n = 0; n < 40; ++n) {
    const Pixels pixels = bars(n);
    Layers frame = layers(extent, pixels, pixels);
    std::vector<SelectionStroke> strokes;
    if (n == 0) strokes = {{.points = {{45, 60}}}};
    if (n == 3) strokes = {{.points = {{105, 60}}}};
    if (n == 6) strokes = {{.subtract = true, .points = {{45, 60}}}};
    const Pixels mask = select(selection, frame, {}, strokes);
    const auto at = [&](uint32_t x, uint32_t y) { return mask[4 * (y * extent.width + x)]; };
    EXPECT_EQ(at(45, 60) > .5F, n < 6) << "red, frame " << n;
    EXPECT_EQ(at(45, 80) > .5F, n < 6) << "red away from the stroke, frame " << n;
    EXPECT_EQ(at(105, 60) > .5F, n >= 3) << "yellow, frame " << n;
    EXPECT_LT(at(75, 60), .5F) << "wall, frame " << n;
  }
}

TEST_F(SelectionTest, AnObjectThatComesBackIsFound) {
  const Extent extent{320, 240};
  Selection selection(device, extent);
  for (int n = 0; n < 20; ++n) {
    const bool away = n > 3 && n < 12;
    const Point center{away ? -500.F : n < 4 ? 100.F : 200.F, 120};
    const Pixels pixels = discs(extent, center, unsigned(n));
    Layers frame = layers(extent, pixels, pixels);
    std::vector<SelectionStroke> strokes;
    if (n == 0) strokes = {{.points = {center}}};
    const Pixels mask = select(selection, frame, {}, strokes);
    if (n != 4 && n != 12) {
      EXPECT_LT(wrong_share(mask, extent,
                            [&](float x, float y) {
                              return std::hypot(x - center[0], y - center[1]) < 60;
                            }),
                .02)
          << "frame " << n;
    }
  }
}

TEST_F(SelectionTest, AfterACutTheObjectIsFoundAtOnce) {
  const Extent extent{320, 240};
  Selection selection(device, extent);
  ObjectSelection::State early;
  const auto object_at = [&](float x, unsigned seed, const std::vector<SelectionStroke>& strokes) {
    const Pixels pixels = discs(extent, {x, 120}, seed);
    Layers frame = layers(extent, pixels, pixels);
    return wrong_share(select(selection, frame, {}, strokes), extent,
                       [&](float u, float v) { return std::hypot(u - x, v - 120) < 60; });
  };
  EXPECT_LT(object_at(100, 0, {{.points = {{100, 120}}}}), .02);
  run([&](gpu::Commands& commands) { early = selection.save(commands); });
  for (const float x : {220.F, 80.F, 160.F}) {
    run([&](gpu::Commands& commands) { selection.lose(commands); });
    EXPECT_LT(object_at(x, 1, {}), .02) << x;
  }
  // A stroke on the wall is undone.
  EXPECT_GT(object_at(160, 2, {{.points = {{300, 20}, {300, 220}, {20, 220}}, .radius = 10}}), .03);
  run([&](gpu::Commands& commands) {
    selection.restore(commands, early);
    selection.lose(commands);
  });
  EXPECT_LT(object_at(160, 3, {}), .02);
}

TEST_F(SelectionTest, MotionBlurIsAMixture) {
  // A disc of one color before another color, blurred along x: alpha is known.
  const Extent extent{160, 120};
  Pixels frame(4 * extent.pixels(), 1);
  std::vector<double> alpha(extent.pixels());
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      double a = 0;
      for (int k = 0; k < 9; ++k)
        a += std::hypot(double(x) - 80 + .5 * (k - 4), double(y) - 60) < 35;
      alpha[size_t{y} * extent.width + x] = a /= 9;
      const double front[] = {.7, .1, .08}, back[] = {.1, .3, .5};
      for (size_t c = 0; c < 3; ++c)
        frame[4 * (size_t{y} * extent.width + x) + c] = float(a * front[c] + (1 - a) * back[c]);
    }
  Selection selection(device, extent);
  Layers layered = layers(extent, frame, frame);
  const Pixels mask = select(selection, layered, {}, {{.points = {{80, 60}}}});
  double sum = 0, worst = 0;
  for (size_t i = 0; i < alpha.size(); ++i) {
    const double off = std::abs(alpha[i] - double(mask[4 * i]));
    sum += off;
    worst = std::max(worst, off);
  }
  EXPECT_LT(worst, .2);  // a tenth at either end is rounded (kMargin)
  EXPECT_LT(sum / double(alpha.size()), .004);
}

TEST_F(SelectionTest, NothingIsSelectedWithoutStrokes) {
  const Extent extent{50, 30};
  const Pixels pixels = random_pixels(extent, 1);
  Selection selection(device, extent);
  Layers frame = layers(extent, pixels, pixels);
  for (const float v : select(selection, frame, {})) EXPECT_EQ(v, 0);
  // Nor by strokes that only subtract, nor by such that miss the frame.
  Layers again = layers(extent, pixels, pixels);
  for (const float v : select(selection, again, {},
                              {{.subtract = true, .points = {{5, 5}}}, {.points = {{-900, 5}}}}))
    EXPECT_EQ(v, 0);
}

TEST_F(SelectionTest, TakesAnyPixels) {
  const Extent extent{64, 40};
  constexpr float kOdd[] = {0, -1, 1e-30F, 65504, kInf, kNan, 1e30F};
  Selection selection(device, extent);
  for (const float odd : kOdd) {
    Layers frame =
        layers(extent, Pixels(4 * extent.pixels(), odd), Pixels(4 * extent.pixels(), odd));
    for (const float v : select(selection, frame, {}, {{.points = {{30, 20}}}}, true))
      ASSERT_TRUE(std::isfinite(v)) << odd;
  }
}

}  // namespace inverse::testing
