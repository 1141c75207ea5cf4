// SPDX-License-Identifier: LGPL-2.1-or-later
// What strokes cover, against tests/reference/image/strokes.*.
#include "strokes_fixture.hpp"

namespace inverse::testing {
namespace {

using Kind = Stroke::Kind;

class StrokeMaskTest : public GpuTest {
 protected:
  Pixels mask_of(const StrokeList& list, Extent extent) {
    StrokeMask mask(device, extent);
    run([&](gpu::Commands& commands) {
      mask.set(commands, std::make_shared<StrokeList>(list), {});
    });
    bounds_ = download(mask.strokes());
    return download(mask.pixels());
  }
  /// The first cell of a stroke and the one after the last, along x and y.
  std::vector<int> bounds(size_t stroke) const {
    const auto* at = &bounds_[4 * shaders::image_strokes_place::STROKE_STRIDE * stroke];
    return {at, at + 4};
  }

 private:
  Pixels bounds_;
};

TEST_F(StrokeMaskTest, FallsOffTowardItsBorder) {
  const StrokeList list{{{Kind::shading, {{20, 16}, {40, 16}}, 8}}, {64, 32}};
  const Pixels mask = mask_of(list, list.frame);
  const auto weight = [&](uint32_t x, uint32_t y) {
    return mask_at(mask, list.frame, x, y).weight;
  };
  EXPECT_EQ(mask_at(mask, list.frame, 30, 16).stroke, 0);
  EXPECT_NEAR(weight(30, 16), 1, 1e-6);
  EXPECT_NEAR(weight(30, 12), 1, 1e-6);
  EXPECT_NEAR(weight(30, 8), .25 * .25, 1e-4);  // .5 of 2 pixels from the border
  EXPECT_EQ(weight(30, 7), 0);
  EXPECT_EQ(weight(10, 16), 0);
  const auto box = bounds(0);
  EXPECT_TRUE(box[0] <= 3 && box[1] <= 2 && box[2] >= 12 && box[3] >= 6);
  EXPECT_TRUE(box[0] >= 2 && box[1] >= 1 && box[2] <= 13 && box[3] <= 7);
  // At half size, the same place.
  const Extent half{32, 16};
  const Pixels smaller = mask_of(list, half);
  EXPECT_NEAR(mask_at(smaller, half, 15, 8).weight, 1, 1e-6);
  EXPECT_EQ(mask_at(smaller, half, 15, 3).stroke, -1);
}

TEST_F(StrokeMaskTest, AgreesWithReference) {
  for (const Extent extent : {Extent{1, 1}, {5, 3}, {17, 40}, {101, 67}, {349, 287}}) {
    const auto w = float(extent.width), h = float(extent.height);
    const StrokeList list{
        {{Kind::shading, {{.1F * w, .2F * h}, {.8F * w, .3F * h}}, .1F * h},
         {Kind::reflectance, {{.5F * w, -h}, {.5F * w, h}, {.9F * w, 2 * h}}, .06F * h},
         {Kind::recolor, {{-9 * w, 0}}, 20},
         {Kind::shading, {{.3F * w, .8F * h}, {.3F * w, .8F * h}}, .2F * h},
         {Kind::reflectance, {{.2F * w, .8F * h}, {.6F * w, .75F * h}}, .12F * h}},
        extent};
    const auto lines = reference_lines(list, extent);
    const auto expected =
        reference::draw_strokes(lines, std::vector<reference::StrokeMove>(lines.size()),
                                int(extent.width), int(extent.height));
    const Pixels mask = mask_of(list, extent);
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x) {
        const MaskPixel got = mask_at(mask, extent, x, y);
        const size_t i = size_t{y} * extent.width + x;
        ASSERT_NEAR(got.weight, expected.weight[i], 1e-3)
            << name_of(extent) << " " << x << "," << y;
        if (expected.weight[i] > 1e-4) {
          ASSERT_EQ(got.stroke, expected.stroke[i]) << name_of(extent) << " " << x << "," << y;
        }
      }
  }
}

TEST_F(StrokeMaskTest, TakesAnyNumber) {
  const Extent extent{37, 21};
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                  kInf = std::numeric_limits<float>::infinity();
  for (const float odd : {kNan, kInf, -kInf, 1e30F, -1e30F, 0.0F}) {
    const Pixels mask = mask_of({{{Kind::shading, {{odd, 3}, {4, odd}}, 5},
                                  {Kind::shading, {{odd, odd}}, 5},
                                  {Kind::reflectance, {{5, 5}}, odd},
                                  {Kind::reflectance, {}, 5}},
                                 extent},
                                extent);
    for (const float pixel : mask) ASSERT_TRUE(pixel >= 0 && pixel <= 4.5F) << odd;
  }
  std::vector<Stroke> many(kMaxStrokes + 5, {Kind::shading, {{5, 5}}, 3});
  for (const float pixel : mask_of({many, extent}, extent)) ASSERT_LE(pixel, kMaxStrokes + .5F);
}

TEST(UselessStrokes, AreThoseOutsideAndUnderTheOtherKind) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  using Places = std::vector<size_t>;
  for (const Extent extent : {Extent{160, 120}, {3840, 2160}, {7, 5}, {1, 1}, {9000, 3}}) {
    const auto w = float(extent.width), h = float(extent.height);
    const Stroke line{Kind::shading, {{.2F * w, .5F * h}, {.6F * w, .5F * h}}, .1F * w};
    Stroke other = line, longer = line, beside = line, paint = line, thin = line;
    other.kind = longer.kind = beside.kind = thin.kind = Kind::reflectance;
    longer.points.push_back({.7F * w, .5F * h});
    beside.points = {{.9F * w, .5F * h}};
    paint.kind = Kind::recolor;
    thin.radius = .01F;
    const Stroke outside{Kind::shading, {{-w, -h}, {-w, 2 * h}}, .1F * w},
        far{Kind::recolor, {{1e6F, 1e6F}, {2 * w, 3 * h}}, 1}, odd{Kind::shading, {{kNan, 1}}, 3};
    const auto found = [&](std::vector<Stroke> strokes) {
      return find_useless({std::move(strokes), extent});
    };
    EXPECT_EQ(found({line, outside, far, odd}).outside, (Places{1, 2, 3})) << name_of(extent);
    EXPECT_EQ(found({line, other}).under, Places{0}) << name_of(extent);
    EXPECT_EQ(found({line, line, longer}).under, Places{0}) << name_of(extent);
    EXPECT_EQ(found({line, line, paint}).under, Places{}) << name_of(extent);
    if (extent.pixels() < 1000) continue;  // parts of strokes need texels
    EXPECT_EQ(found({line, beside}).under, Places{}) << name_of(extent);
    EXPECT_EQ(found({line, thin}).under, Places{}) << name_of(extent);
    EXPECT_EQ(found({longer, line}).under, Places{}) << name_of(extent);
  }
  EXPECT_EQ(find_useless({}).outside, Places{});
}

TEST_F(StrokeMaskTest, ManyLargeStrokesTakeLittleMemory) {
  const Extent extent{640, 480};
  std::vector<Stroke> many(kMaxStrokes, {Kind::shading, {{320, 240}}, 1000});
  many.back() = {Kind::reflectance, {{100, 100}, {300, 100}}, 40};
  const StrokeList list{many, extent};
  const StrokePatches patches = draw_patches(list, extent);
  EXPECT_LE(patches.depths.size(), kMaxCover * extent.pixels() + kMaxStrokes * 16);
  const Pixels mask = mask_of(list, extent);
  EXPECT_EQ(mask_at(mask, extent, 200, 100).stroke, int(kMaxStrokes) - 1);
  EXPECT_EQ(mask_at(mask, extent, 400, 300).stroke, int(kMaxStrokes) - 2);
  EXPECT_NEAR(mask_at(mask, extent, 400, 300).weight, 1, 1e-6);
}

}  // namespace
}  // namespace inverse::testing
