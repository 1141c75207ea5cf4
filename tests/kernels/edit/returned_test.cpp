// SPDX-License-Identifier: LGPL-2.1-or-later
// What effects changed in pictures of layers: the kernel against its specification.
#include "tests/reference/edit/returned.hpp"

#include "kernels/edit/returned.hpp"
#include "tests/kernels/edit/edit_fixture.hpp"

namespace inverse::testing {
namespace {

using Layer = ReturnedPicture::Layer;
using reference::Rgb;
using reference::Rgba;

constexpr Layer kLayers[] = {Layer::reflectance, Layer::shading, Layer::direct, Layer::indirect,
                             Layer::mask};

/// What the frame and the picture have.
struct Case {
  Layer layer = Layer::shading;
  bool light = false, lamp = false, slope = false, gray = false, matte = false, gamut = false;
  bool evil = false;
  Extent picture{};
};

/// As pictures are: of few values, many of them the same, some 0 and some 1.
Pixels codes(Extent extent, unsigned seed, float levels = 16) {
  Pixels pixels = random_pixels(extent, seed);
  for (float& p : pixels) p = std::round(p * levels) / levels;
  return pixels;
}

}  // namespace

class ReturnedTest : public GpuTest {
 protected:
  struct Frame {
    Layers layers;
    Pixels intrinsic, light, lamp, slope, mask, sent, returned;
    Gamut gamut;
  };
  Frame frame(Extent extent, const Case& with, unsigned seed) {
    Frame made;
    const auto layer = [&](float high) {
      Pixels pixels = random_pixels(extent, ++seed, 0, high);
      return with.evil ? with_extremes(std::move(pixels), seed) : pixels;
    };
    made.intrinsic = layer(1.5F);
    made.light = layer(1.5F);
    made.mask = layer(1);
    made.lamp = {1.2F, 1, 0.7F, 0};
    made.slope = {0.6F, -0.5F, 1, 0};
    const Extent size = with.picture.width ? with.picture : extent;
    made.sent = codes(size, ++seed);
    made.returned = codes(size, ++seed);
    if (with.evil) {
      made.sent = with_extremes(made.sent, ++seed);
      made.returned = with_extremes(made.returned, ++seed);
    }
    if (with.gamut) made.gamut = gamut_between(Primaries::bt709(), Primaries::bt2020());
    Layers& layers = made.layers;
    layers.extent = extent;
    layers[Role::model] = layers[Role::intrinsic] = shared_plane(extent, made.intrinsic);
    if (with.light)
      layers[Role::model_light] = layers[Role::light] = shared_plane(extent, made.light);
    if (with.lamp) layers[Role::lamp] = shared_plane({1, 1}, made.lamp);
    if (with.slope) layers[Role::slope] = shared_plane({1, 1}, made.slope);
    layers[Role::mask] = shared_plane(extent, made.mask);
    return made;
  }

  void edit(Frame& made, const Case& with, float gain, float strength) {
    const Extent size = with.picture.width ? with.picture : made.layers.extent;
    const Plane sent = plane(size, made.sent), returned = plane(size, made.returned);
    ReturnedEdit edit(device, made.layers.extent);
    const PlanePtr matte = with.matte ? made.layers[Role::mask] : nullptr;
    run([&](gpu::Commands& commands) {
      edit.record(commands, made.layers,
                  {.layer = with.layer,
                   .sent = sent,
                   .returned = returned,
                   .gain = gain,
                   .gray = with.gray,
                   .gamut = made.gamut},
                  strength, matte);
    });
  }

  static reference::Light light_of(const Frame& made, const Case& with, size_t n) {
    reference::Light light;
    light.shading = reference::finite(pixel_of(made.intrinsic, n))[3];
    if (with.light) light.color = reference::finite(pixel_of(made.light, n));
    if (with.lamp) light.lamp = {made.lamp[0], made.lamp[1], made.lamp[2]};
    if (with.slope) light.own = {made.slope[0], 0, made.slope[1]};
    return light;
  }

  /// Compares every pixel with the reference; products of light where its parts may be huge.
  void expect_as_specified(Extent extent, const Case& with, float gain, float strength,
                           unsigned seed) {
    SCOPED_TRACE(name_of(extent) + " picture " + name_of(with.picture) + " layer " +
                 std::to_string(static_cast<int>(with.layer)) + " light " +
                 std::to_string(with.light) + " lamp " + std::to_string(with.lamp) + " slope " +
                 std::to_string(with.slope) + " gray " + std::to_string(with.gray) + " matte " +
                 std::to_string(with.matte) + " gamut " + std::to_string(with.gamut) + " evil " +
                 std::to_string(with.evil));
    Frame made = frame(extent, with, seed);
    reference::ReturnedPicture picture{reference_of(made.sent), reference_of(made.returned)};
    const Extent size = with.picture.width ? with.picture : extent;
    picture.width = size.width;
    picture.height = size.height;
    picture.gain = gain;
    std::ranges::copy(made.gamut.matrix, picture.gamut.begin());
    edit(made, with, gain, strength);
    const bool mask = with.layer == Layer::mask;
    const Pixels got = download(made.layers[mask ? Role::mask : Role::intrinsic]);
    const Pixels light = made.layers[Role::light] ? download(made.layers[Role::light]) : Pixels{};
    ASSERT_TRUE(are_light(got) && are_light(light));
    for (size_t n = 0; n < extent.pixels(); ++n) {
      const size_t x = n % extent.width, y = n / extent.width;
      const double matte =
          with.matte ? std::min(reference::finite(pixel_of(made.mask, n))[0], 1.0) : 1;
      const double weight = strength * matte;
      const auto change = [&](const Rgb& v) {
        return reference::change_at(v, picture, x, y, extent.width, extent.height);
      };
      const Rgba before = reference::finite(pixel_of(mask ? made.mask : made.intrinsic, n));
      Rgba expected = before;
      double scale = 1;  // of rounding: of numbers that were added
      if (with.layer == Layer::reflectance) {
        const Rgb d = change({before[0], before[1], before[2]});
        expected = reference::edited_reflectance(before, d, weight);
        scale +=
            std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]) + before[0] + before[1] + before[2];
      } else if (mask) {
        const Rgb d = change({before[0], before[0], before[0]});
        expected = reference::edited_mask(before, d, weight);
        scale += std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]) + before[0];
      } else {
        using Part = reference::LightPart;
        const reference::Light was = light_of(made, with, n);
        const Part part = with.layer == Layer::shading  ? Part::all
                          : with.layer == Layer::direct ? Part::direct
                                                        : Part::indirect;
        const Rgb v = part == Part::all      ? was.total()
                      : part == Part::direct ? was.direct()
                                             : was.indirect();
        const Rgb d = change(v);
        const bool tint = !with.gray || with.light || with.slope;
        const reference::Light now = reference::edited_light(was, part, d, weight, tint);
        reference::Light seen = now;
        seen.shading = got[4 * n + 3];
        if (tint) seen.color = pixel_of(light, n);
        const double sum = std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]) + was.total()[0] +
                           was.total()[1] + was.total()[2];
        for (size_t c = 0; c < 3; ++c)
          ASSERT_NEAR(seen.total()[c], now.total()[c], 2e-4 * (1 + sum + now.total()[c]))
              << "light of pixel " << n;
        // S and the direct share are quotients: as far off as their dividend.
        const double total = was.total()[0] + was.total()[1] + was.total()[2];
        if (total > 1e-6 * sum) scale += now.shading + was.shading * (sum + 1) / total;
        expected[3] = now.shading;
        if (total <= 1e-6 * sum) expected[3] = got[4 * n + 3];
      }
      for (size_t c = 0; c < 4; ++c)
        ASSERT_NEAR(got[4 * n + c], expected[c], 1e-4 * scale) << "pixel " << n << ", " << c;
    }
  }
};

TEST_F(ReturnedTest, LayersChangeAsSpecified) {
  unsigned seed = 1;
  for (const Extent extent : kOddSizes) {
    if (extent.pixels() > 5000) continue;
    for (const Layer layer : kLayers)
      for (const bool evil : {false, true})
        for (const bool matte : {false, true})
          expect_as_specified(extent, {.layer = layer, .matte = matte, .evil = evil}, 0.5F,
                              matte ? 0.7F : 1, seed += 10);
  }
}

TEST_F(ReturnedTest, LightOfEveryKindChangesAsSpecified) {
  unsigned seed = 1000;
  for (const Layer layer : {Layer::shading, Layer::direct, Layer::indirect})
    for (int bits = 0; bits < 32; ++bits)
      expect_as_specified({17, 5},
                          {.layer = layer,
                           .light = (bits & 1) != 0,
                           .lamp = (bits & 2) != 0,
                           .slope = (bits & 4) != 0,
                           .gray = (bits & 8) != 0,
                           .evil = (bits & 16) != 0},
                          0.5F, 1, seed += 10);
}

TEST_F(ReturnedTest, PicturesOfAnotherSizeAndOfOtherPrimariesDoToo) {
  unsigned seed = 3000;
  for (const Layer layer : kLayers)
    for (const Extent picture : {Extent{1, 1}, Extent{7, 5}, Extent{15, 11}, Extent{40, 30}})
      for (const bool gamut : {false, true})
        expect_as_specified({15, 10}, {.layer = layer, .gamut = gamut, .picture = picture}, 2, 0.5F,
                            seed += 10);
  expect_as_specified({349, 287}, {.layer = Layer::reflectance, .picture = {100, 90}}, 1, 1, seed);
}

TEST_F(ReturnedTest, WhatCameBackAsItWasSentKeepsEveryBit) {
  unsigned seed = 5000;
  for (const Layer layer : kLayers)
    for (const Extent picture : {Extent{}, Extent{7, 5}})
      for (const bool all : {false, true}) {
        const Case with{.layer = layer,
                        .light = all,
                        .lamp = all,
                        .slope = all,
                        .matte = all,
                        .gamut = all,
                        .picture = picture};
        Frame made = frame({64, 48}, with, seed += 10);
        made.returned = made.sent;
        edit(made, with, 0.3F, 0.9F);
        EXPECT_EQ(download(made.layers[Role::intrinsic]), made.intrinsic);
        EXPECT_EQ(download(made.layers[Role::mask]), made.mask);
        if (all) {
          EXPECT_EQ(download(made.layers[Role::light]), made.light);
        } else if (made.layers[Role::light]) {
          EXPECT_EQ(download(made.layers[Role::light]), Pixels(size_t{64} * 48 * 4, 1));
          EXPECT_EQ(download(made.layers[Role::model_light]), Pixels(size_t{64} * 48 * 4, 1));
        }
      }
}

TEST_F(ReturnedTest, NothingIsDoneWithoutStrengthOrGainAndNothingToPlanesOfOthers) {
  const Case with{.layer = Layer::shading};
  for (const auto& [gain, strength] : {std::pair{0.0F, 1.0F}, {1.0F, 0.0F}, {1.0F, kNan}}) {
    Frame made = frame({15, 10}, with, 3);
    edit(made, with, gain, strength);
    EXPECT_EQ(made.layers[Role::intrinsic], made.layers[Role::model]);
    EXPECT_EQ(made.layers[Role::light], nullptr);
  }
  Frame made = frame({15, 10}, with, 3);
  edit(made, with, 1, 1);
  EXPECT_NE(made.layers[Role::intrinsic], made.layers[Role::model]);
  EXPECT_EQ(download(made.layers[Role::model]), made.intrinsic);
}

}  // namespace inverse::testing
