// SPDX-License-Identifier: LGPL-2.1-or-later
// The user's strokes in intrinsicdecomp, against tests/reference/intrinsic/strokes.*.
#include <limits>

#include "intrinsic_fixture.hpp"
#include "kernels/intrinsic/scaled_intrinsic.hpp"
#include "tests/kernels/image/strokes_fixture.hpp"

namespace inverse::testing {
namespace {

using Kind = Stroke::Kind;

reference::StrokeMask reference_mask(const StrokeList& list, Extent extent) {
  reference::StrokeMask result;
  for (const Stroke& stroke : list.strokes)
    result.kinds.push_back(stroke.kind == Kind::shading ? reference::StrokeKind::shading
                                                        : reference::StrokeKind::reflectance);
  const auto lines = reference_lines(list, extent);
  const auto drawn =
      reference::draw_strokes(lines, std::vector<reference::StrokeMove>(lines.size()),
                              int(extent.width), int(extent.height));
  result.stroke = drawn.stroke;
  result.weight = drawn.weight;
  return result;
}

/// Strokes of both kinds, one across the border, one over another, one that misses the frame.
StrokesPtr several(Extent extent) {
  const auto w = float(extent.width), h = float(extent.height);
  return std::make_shared<StrokeList>(
      StrokeList{{{Kind::shading, {{.1F * w, .2F * h}, {.8F * w, .3F * h}}, .1F * h},
                  {Kind::reflectance, {{.5F * w, -h}, {.5F * w, h}, {.9F * w, 2 * h}}, .06F * h},
                  {Kind::shading, {{-9 * w, 0}}, 20},
                  {Kind::reflectance, {{.2F * w, .8F * h}}, .12F * h}},
                 extent});
}

class StrokesTest : public IntrinsicTest {
 protected:
  template <typename Method>
  Pixels frame(Method& method, const PlanePtr& in, const StrokesPtr& strokes,
               const typename Method::Params& params = {}, bool reset = false) {
    Layers layers;
    run([&](gpu::Commands& commands) {
      typename Method::FrameInfo info;
      info.reset = reset;
      info.strokes = strokes;
      layers = method.record(commands, in, params, info);
    });
    return download(layers[Role::intrinsic]);
  }
};

TEST_F(StrokesTest, WholeSolveAgreesWithReference) {
  for (const Extent extent : kOddSizes) {
    const Pixels pixels = scene(extent, 1);
    const StrokesPtr strokes = several(extent);
    const auto mask = reference_mask(*strokes, extent);
    const auto expected = expected_of(extent, pixels, {.strokes = &mask}).log_shading;
    IntrinsicDecomposition method(device, extent);
    const Pixels got = frame(method, input(extent, pixels), strokes, {.adaptive = false}, true);
    const double scale = double(method.findings().scale);
    double worst = 0;
    for (size_t i = 0; i < extent.pixels(); ++i)
      worst = std::max(worst, std::abs(std::log(double(got[4 * i + 3])) + scale - expected[i]));
    EXPECT_LT(worst, 1e-3) << name_of(extent);
    // What it says of each stroke is so.
    const auto found = method.findings().strokes;
    ASSERT_EQ(found.size(), mask.kinds.size());
    const reference::Guide guide = guide_of(extent, pixels);
    for (size_t k = 0; k < found.size(); ++k) {
      double sum = 0, squares = 0, weight = 0;
      for (size_t i = 0; i < extent.pixels(); ++i) {
        if (mask.stroke[i] != int(k)) continue;
        const double v = mask.kinds[k] == reference::StrokeKind::shading
                             ? expected[i]
                             : guide.level[0].m[i] - expected[i];
        weight += mask.weight[i], sum += mask.weight[i] * v, squares += mask.weight[i] * v * v;
      }
      const double rms =
          weight > 0 ? std::sqrt(std::max(squares / weight - std::pow(sum / weight, 2), 0.0)) : 0;
      EXPECT_NEAR(double(found[k]), rms, 1e-3) << name_of(extent) << ", stroke " << k;
    }
  }
}

/// A checkerboard under light that falls off toward the right.
Pixels checkerboard(Extent extent) {
  Pixels pixels(extent.pixels() * 4, 1);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const bool board = x > 30 && x < 130 && y > 20 && y < 100;
      const float paint = !board ? .45F : (x / 10 + y / 10) % 2 ? .08F : .7F;
      for (size_t c = 0; c < 3; ++c)
        pixels[packed(extent, 0, 0) + 4 * (size_t{y} * extent.width + x) + c] =
            paint * (.8F - .3F * float(x) / float(extent.width));
    }
  return pixels;
}

const Extent kBoard{160, 120};
const StrokesPtr kOverTheBoard =
    std::make_shared<StrokeList>(StrokeList{{{Kind::shading, {{50, 60}, {110, 60}}, 32}}, kBoard});

/// Standard deviation of ln S well inside the stroke.
double texture_in_shading(const Pixels& intrinsic) {
  double sum = 0, squares = 0, count = 0;
  for (uint32_t y = 40; y < 80; ++y)
    for (uint32_t x = 45; x < 115; ++x) {
      const double s = std::log(double(intrinsic[4 * (size_t{y} * kBoard.width + x) + 3]));
      sum += s, squares += s * s, ++count;
    }
  return std::sqrt(squares / count - std::pow(sum / count, 2));
}

TEST_F(StrokesTest, TextureLeavesTheShadingWithTheFirstFrame) {
  const PlanePtr in = input(kBoard, checkerboard(kBoard));
  ScaledIntrinsic method(device, kBoard);
  const ScaledIntrinsic::Params params;
  for (int i = 0; i < 6; ++i) frame(method, in, {}, params, i == 0);
  const double before = texture_in_shading(frame(method, in, {}, params));
  EXPECT_GT(before, .3) << "the picture must be one that is got wrong";
  const float scale = method.findings(method.recorded() - 1).scale;
  const double with = texture_in_shading(frame(method, in, kOverTheBoard, params));
  EXPECT_LT(with, .15 * before);
  EXPECT_EQ(last_stats(method).plan.history, false);
  EXPECT_NEAR(method.findings(method.recorded() - 1).scale, scale, .5)
      << "brightness must not jump";
  for (int i = 0; i < 4; ++i) frame(method, in, kOverTheBoard, params);
  EXPECT_TRUE(last_stats(method).plan.history);
  EXPECT_LT(texture_in_shading(frame(method, in, kOverTheBoard, params)), .15 * before);
  // And as before, once it is taken away.
  EXPECT_GT(texture_in_shading(frame(method, in, {}, params)), .9 * before);
}

TEST_F(StrokesTest, HoldAtHalfAndQuarterResolution) {
  const PlanePtr in = input(kBoard, checkerboard(kBoard));
  for (const bool quarter : {false, true}) {
    ScaledIntrinsic method(device, kBoard);
    ScaledIntrinsic::Params params;
    params.half_resolution = true;
    params.quarter_resolution = quarter;
    const double without = texture_in_shading(frame(method, in, {}, params, true));
    EXPECT_LT(texture_in_shading(frame(method, in, kOverTheBoard, params)), .3 * without);
  }
}

TEST_F(StrokesTest, EdgesThatAreReusedKeepTheirStrokes) {
  IntrinsicDecomposition one(device, kBoard), other(device, kBoard);
  IntrinsicDecomposition::Params adaptive, whole;
  whole.adaptive = false;
  const Pixels still = checkerboard(kBoard);
  for (int time = 0; time < 24; ++time) {
    Pixels pixels = still;  // a patch moves through the stroke's end
    for (uint32_t y = 56; y < 64; ++y)
      for (uint32_t x = 100; x < 108; ++x)
        for (size_t c = 0; c < 3; ++c)
          pixels[4 * (size_t{y} * kBoard.width + x + static_cast<uint32_t>(time)) + c] = .3F;
    const PlanePtr in = input(kBoard, pixels);
    const Pixels got = frame(one, in, kOverTheBoard, adaptive, time == 0);
    const Pixels want = frame(other, in, kOverTheBoard, whole, time == 0);
    EXPECT_LT(shading_distance(got, want), .05) << "frame " << time;
    EXPECT_LT(texture_in_shading(got), 1.3 * texture_in_shading(want) + .01) << "frame " << time;
  }
  EXPECT_LT(one.findings().tiles_evaluated, TileList::count(kBoard))
      << "edges must have been reused";
}

TEST_F(StrokesTest, FillingAgreesWithReference) {
  for (const Extent extent : {Extent{1, 1}, Extent{17, 5}, Extent{64, 48}, Extent{349, 287}}) {
    // Reflectance in steps of .08, so that no pixel is near kFillDistance.
    std::mt19937 random(5);
    std::vector<float> steps(64);
    for (float& step : steps) step = .08F * float(random() % 4);
    Pixels reflectance(extent.pixels() * 4, 1);
    std::vector<double> rgb;
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x)
        for (size_t c = 0; c < 3; ++c) {
          const float value = .2F + steps[(x / 9 * 5 + y / 7 * 11 + y / 31) % steps.size()];
          reflectance[4 * (size_t{y} * extent.width + x) + c] = value;
          rgb.push_back(double(value));
        }
    const auto w = float(extent.width), h = float(extent.height);
    const auto list = std::make_shared<StrokeList>(
        StrokeList{{{Kind::shading, {{.1F * w, .5F * h}}, 2, true},
                    {Kind::reflectance, {{.9F * w, .2F * h}}, 2, true},
                    {Kind::reflectance, {{.5F * w, .8F * h}}, 4, false}},
                   extent});
    auto expected = reference_mask(*list, extent);
    reference::fill_strokes({true, true, false}, rgb.data(), int(extent.width), expected);
    const gpu::BufferPtr plane = shared_plane(extent, reflectance)->buffer;
    Strokes strokes(device, extent);
    run([&](gpu::Commands& commands) { strokes.set(commands, list, {}); });
    EXPECT_TRUE(strokes.mask().unfilled());
    run([&](gpu::Commands& commands) { strokes.fill(commands, {.reflectance = plane}, nullptr); });
    EXPECT_FALSE(strokes.mask().unfilled());
    const Pixels mask = download(strokes.mask().pixels());
    size_t filled = 0;
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x) {
        const size_t i = size_t{y} * extent.width + x;
        const float pixel = mask[packed(extent, x, y)];
        ASSERT_EQ(int(pixel) - 1, expected.stroke[i]) << name_of(extent) << " " << x << "," << y;
        ASSERT_NEAR(2 * (pixel - std::floor(pixel)), expected.weight[i], 1e-4);
        filled += pixel > 0;
      }
    if (extent.width > 300) {
      EXPECT_GT(filled, 200U) << "the picture must have what to fill";
    }
  }
}

TEST_F(StrokesTest, ADotFillsItsSurface) {
  // Cloth of one paint with sharp stripes of light, before another.
  Pixels pixels(kBoard.pixels() * 4, 1);
  for (uint32_t y = 0; y < kBoard.height; ++y)
    for (uint32_t x = 0; x < kBoard.width; ++x) {
      const bool cloth = x > 30 && x < 130 && y > 20 && y < 100;
      const float light = (x + y / 3) % 17 < 5 ? .5F : .6F;
      const std::array<float, 3> paint =
          cloth ? std::array{.6F, .15F, .15F} : std::array{.1F, .2F, .5F};
      for (size_t c = 0; c < 3; ++c)
        pixels[4 * (size_t{y} * kBoard.width + x) + c] = paint[c] * light;
    }
  const PlanePtr in = input(kBoard, pixels);
  ScaledIntrinsic method(device, kBoard);
  const auto list =
      std::make_shared<StrokeList>(StrokeList{{{Kind::reflectance, {{80, 60}}, 6, true}}, kBoard});
  const auto spread = [&](const Pixels& layers) {
    double sum = 0, squares = 0, count = 0;
    for (uint32_t y = 25; y < 95; ++y)
      for (uint32_t x = 35; x < 125; ++x) {
        const double r = std::log(double(layers[4 * (size_t{y} * kBoard.width + x)]));
        sum += r, squares += r * r, ++count;
      }
    return std::sqrt(squares / count - std::pow(sum / count, 2));
  };
  const double before = spread(frame(method, in, {}, {}, true));
  const auto unfilled =
      std::make_shared<StrokeList>(StrokeList{{{Kind::reflectance, {{80, 60}}, 6, false}}, kBoard});
  EXPECT_GT(spread(frame(method, in, unfilled, {}, true)), .7 * before);
  EXPECT_GT(spread(frame(method, in, unfilled)), .7 * before);
  ASSERT_GT(before, .01) << "the picture must be one that is got wrong";
  frame(method, in, list);
  EXPECT_FALSE(method.converged(method.recorded() - 1, {})) << "the next frame fills";
  const Pixels filled = frame(method, in, list);
  EXPECT_LT(spread(filled), .4 * before);
  // They are filled anew after a seek.
  EXPECT_GT(spread(frame(method, in, list, {}, true)), .7 * before);
  EXPECT_LT(spread(frame(method, in, list)), .4 * before);
  EXPECT_GT(spread(frame(method, in, {}, {}, true)), .9 * before);
  // Also those that come with a seek.
  const auto other = std::make_shared<StrokeList>(*list);
  EXPECT_GT(spread(frame(method, in, other, {}, true)), .7 * before);
  EXPECT_LT(spread(frame(method, in, other)), .4 * before);
}

TEST_F(StrokesTest, ContradictoryStrokesStayFinite) {
  const Extent extent{64, 48};
  Pixels pixels = scene(extent, 3);
  for (size_t i = 0; i < 400; ++i)
    pixels[37 * i % pixels.size()] = i % 2 ? 0 : std::numeric_limits<float>::quiet_NaN();
  std::vector<Stroke> strokes;
  for (int i = 0; i < 64; ++i)
    strokes.push_back({i % 2 ? Kind::shading : Kind::reflectance,
                       {{float(i), 0}, {float(64 - i), 48}},
                       float(1 + i % 7)});
  IntrinsicDecomposition method(device, extent);
  const auto list = std::make_shared<StrokeList>(StrokeList{strokes, extent});
  for (int i = 0; i < 3; ++i)
    for (const float v : frame(method, input(extent, pixels), list, {}, i == 0))
      ASSERT_TRUE(std::isfinite(v));
  for (const float rms : method.findings().strokes) EXPECT_TRUE(rms >= 0 && rms < 20);
}

}  // namespace
}  // namespace inverse::testing
