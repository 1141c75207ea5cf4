// SPDX-License-Identifier: LGPL-2.1-or-later
// Drawn frames: blurs against Gaussians, the kernels against their specification.
#include "kernels/edit/stylize/stylize.hpp"

#include <algorithm>
#include <cmath>

#include "tests/kernels/edit/edit_fixture.hpp"
#include "tests/reference/edit/stylize.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {
namespace {

reference::LayersField field_of(Extent extent, const Pixels& pixels) {
  return {extent.width, extent.height, reference_of(pixels)};
}

reference::StylizeSpec spec_of(const StylizeParams& p) {
  return {p.scale, p.sensitivity, p.sharpness, p.levels, p.softness, p.flatten, p.strength};
}

/// Shading that falls from 1 to 1/4 at x = width / 2, on gray paint.
Pixels step_pixels(Extent extent, float dark = .25F) {
  Pixels pixels(4 * extent.pixels(), .5F);
  for (size_t n = 0; n < extent.pixels(); ++n)
    pixels[4 * n + 3] = n % extent.width < extent.width / 2 ? 1 : dark;
  return pixels;
}

}  // namespace

class StylizeTest : public EditorTest {
 protected:
  Pixels record(Layers& layers, const StylizeParams& params) {
    Stylize stylize(device, layers.extent);
    run([&](gpu::Commands& commands) { stylize.record(commands, layers, params); });
    return download(layers[Role::intrinsic]);
  }
  Pixels stylized(Extent extent, const Pixels& pixels, const StylizeParams& params) {
    Layers frame = layers(extent, pixels);
    return record(frame, params);
  }
  void expect_reference(Extent extent, const Pixels& pixels, const StylizeParams& params,
                        const std::string& what) {
    const Pixels got = stylized(extent, pixels, params);
    const auto expected = reference::stylize(field_of(extent, pixels), {}, spec_of(params));
    for (size_t i = 0; i < got.size(); ++i) {
      const double wanted = expected.pixels[i / 4][i % 4];
      ASSERT_TRUE(std::isfinite(got[i])) << what << " at " << i;
      ASSERT_NEAR(double{got[i]}, wanted, 2e-3 * (1 + std::abs(wanted))) << what << " at " << i;
    }
  }
};

TEST_F(StylizeTest, AgreesWithReference) {
  for (const Extent extent : kOddSizes)
    for (const bool hostile : {false, true})
      for (const float scale : {.3F, 2.F, 3.7F, 50.F}) {
        if (extent.pixels() > 200000 && scale != 3.7F) continue;
        const Pixels pixels = any_pixels(extent, extent.width, hostile);
        StylizeParams params{.scale = scale, .flatten = .3F};
        if (extent.pixels() > 5000) params.flatten = 0;  // slow in the reference
        ASSERT_NO_FATAL_FAILURE(expect_reference(
            extent, pixels, params,
            name_of(extent) + (hostile ? " hostile " : " ") + std::to_string(scale)));
      }
}

TEST_F(StylizeTest, EveryPartAloneAgreesWithReference) {
  const Extent extent{61, 43};
  const Pixels pixels = any_pixels(extent, 2, true);
  for (const StylizeParams& params :
       {StylizeParams{.levels = 0, .flatten = 0}, StylizeParams{.sensitivity = 0, .flatten = 0},
        StylizeParams{.sensitivity = 0, .levels = 0},
        StylizeParams{.levels = 1, .softness = 1, .flatten = 2, .strength = .3F},
        StylizeParams{.scale = 8, .sensitivity = 100, .sharpness = 100, .levels = 2.5F}})
    ASSERT_NO_FATAL_FAILURE(expect_reference(extent, pixels, params, "part"));
}

// The specification of the blur is a grid of cells; a Gaussian is what it has to be near to.
TEST_F(StylizeTest, TheGridIsNearToAGaussian) {
  const Extent extent{160, 96};
  // An impulse, a step and noise; not at the border, where a grid goes on with the mean of a cell.
  Pixels pixels = step_pixels(extent, 0);
  const Pixels noise = random_pixels(extent, 4);
  for (size_t n = 0; n < extent.pixels(); ++n)
    if (n % extent.width >= 80 && n % extent.width < 130 && n / extent.width >= 48 &&
        n / extent.width < 70)
      pixels[4 * n + 3] = noise[n];
  pixels[4 * (20 * 160 + 130) + 3] = 1000;
  const auto field = reference::encoded_shading(field_of(extent, pixels));
  for (const double sigma : {.5, 1.5, 2.9, 3.1, 5.9, 6.1, 11.0, 13.0, 25.0})
    for (const double ratio : {1.0, 1.6}) {
      const auto got = reference::blurred(field, sigma, ratio);
      const auto wanted = reference::gaussian(field, ratio * sigma);
      double largest = 0;
      for (size_t n = 0; n < got.values.size(); ++n)
        update_max(largest, std::abs(got.values[n] - wanted.values[n]));
      EXPECT_LT(largest, .13) << "stops, of 4.4 or 14; sigma " << sigma << ", ratio " << ratio;
    }
}

TEST_F(StylizeTest, TheCostAPixelIsBounded) {
  for (float sigma = StylizeParams::kMinScale; sigma <= StylizeParams::kMaxScale; sigma *= 1.1F) {
    const auto grid = Gaussians::grid_of(sigma);
    EXPECT_LE(grid.radius, 15) << sigma;
    EXPECT_GE(grid.cell_sigma, .29F) << sigma;
  }
}

TEST_F(StylizeTest, LinesAreDarkBesideAStepOfShadingAndOfSensitivity) {
  const Extent extent{96, 64};
  const Pixels pixels = step_pixels(extent);
  const auto darkest = [&](const StylizeParams& params) {
    const Pixels got = stylized(extent, pixels, params);
    float smallest = 1;
    for (size_t n = 0; n < extent.pixels(); ++n)
      smallest = std::min(smallest, got[4 * n + 3] / pixels[4 * n + 3]);
    return smallest;
  };
  // log2((1 + 1/.05) / (1 + .25/.05)) = 1.81 stops.
  for (const float scale : {1.F, 2.F, 4.F, 8.F}) {
    StylizeParams params{.scale = scale, .sharpness = 20, .levels = 0, .flatten = 0};
    params.sensitivity = 1 / 1.5F;
    EXPECT_LT(darkest(params), .05F) << scale;
    params.sensitivity = 1 / 2.1F;
    EXPECT_GT(darkest(params), .999F) << scale;
  }
  // They are on the dark side.
  const Pixels got = stylized(extent, pixels, {.sharpness = 20, .levels = 0, .flatten = 0});
  for (size_t n = 0; n < extent.pixels(); ++n)
    if (n % extent.width < extent.width / 2) {
      ASSERT_EQ(got[4 * n + 3], 1) << n;
    }
}

TEST_F(StylizeTest, PaintGetsNoLines) {
  const Extent extent{64, 48};
  Pixels pixels(4 * extent.pixels(), .8F);
  for (size_t n = 0; n < extent.pixels(); ++n)
    if (n % 16 < 8) std::fill_n(&pixels[4 * n], 3, .1F);
  const Pixels got =
      stylized(extent, pixels, {.sensitivity = 100, .sharpness = 100, .levels = 0, .flatten = .2F});
  for (size_t i = 0; i < got.size(); ++i) ASSERT_NEAR(got[i], pixels[i], 1e-6) << i;
}

TEST_F(StylizeTest, LevelsAreAsManyAsAskedAndBlackStaysBlack) {
  const Extent extent{512, 8};
  Pixels pixels(4 * extent.pixels(), .5F);
  for (size_t n = 0; n < extent.pixels(); ++n) {
    const double e = double(n % 512) / 511 * reference::encoded_shading(1);
    pixels[4 * n + 3] = static_cast<float>(reference::decoded_shading(e));
  }
  const Pixels got = stylized(
      extent, pixels, {.scale = .3F, .sensitivity = 0, .levels = 4, .softness = 0, .flatten = 0});
  std::vector<float> values;
  for (size_t n = 0; n < 512; ++n)
    if (values.empty() || std::abs(values.back() - got[4 * n + 3]) > 1e-4F)
      values.push_back(got[4 * n + 3]);
  ASSERT_EQ(values.size(), 5u);
  for (size_t k = 0; k < 5; ++k)
    EXPECT_NEAR(values[k],
                reference::decoded_shading(double(k) / 4 * reference::encoded_shading(1)), 1e-5);
}

// A frame and the next, which differ by a camera's noise.
TEST_F(StylizeTest, NoiseDoesNotGrow) {
  const Extent extent{128, 96};
  const auto noisy = [&](unsigned seed) {
    Pixels pixels(4 * extent.pixels(), .5F);
    const Pixels noise = random_pixels(extent, seed, .97F, 1.03F);
    for (size_t n = 0; n < extent.pixels(); ++n)
      pixels[4 * n + 3] = noise[4 * n] * (.05F + .9F * float(n % extent.width) / 128);
    return pixels;
  };
  const auto rms = [](const Pixels& a, const Pixels& b) {
    double sum = 0;
    for (size_t i = 3; i < a.size(); i += 4) sum += (double{a[i]} - b[i]) * (double{a[i]} - b[i]);
    return std::sqrt(sum / (double(a.size()) / 4));
  };
  const Pixels one = noisy(1), other = noisy(2);
  EXPECT_LT(rms(stylized(extent, one, {}), stylized(extent, other, {})), .5 * rms(one, other));
}

TEST_F(StylizeTest, MaskMultiplies) {
  const Extent extent{37, 21};
  const Pixels pixels = any_pixels(extent, 3, false), matte = any_pixels(extent, 4, true);
  std::vector<double> weights;
  for (size_t n = 0; n < matte.size(); n += 4) weights.push_back(double{matte[n]});
  for (const bool use_mask : {true, false}) {
    Layers frame = layers(extent, pixels);
    frame[Role::mask] = shared_plane(extent, matte);
    StylizeParams params{};
    params.use_mask = use_mask;
    const Pixels got = record(frame, params);
    const auto expected = reference::stylize(
        field_of(extent, pixels), use_mask ? weights : std::vector<double>(), spec_of(params));
    for (size_t i = 0; i < got.size(); ++i)
      ASSERT_NEAR(double{got[i]}, expected.pixels[i / 4][i % 4], 2e-3) << use_mask << " " << i;
  }
}

TEST_F(StylizeTest, NeutralSettingsRecordNothing) {
  const Extent extent{16, 16};
  Layers frame = layers(extent, random_pixels(extent, 3));
  const Layers before = frame;
  Stylize stylize(device, extent);
  for (const StylizeParams& params : {StylizeParams{.strength = 0}, StylizeParams{.strength = kNan},
                                      StylizeParams{.sensitivity = 0, .levels = 0, .flatten = 0},
                                      StylizeParams{.sharpness = 0, .levels = 0, .flatten = 0}})
    run([&](gpu::Commands& commands) {
      stylize.record(commands, frame, params);
      EXPECT_EQ(commands.dispatches(), 0u);
    });
  EXPECT_EQ(frame.planes, before.planes);
}

TEST_F(StylizeTest, SharedPlanesStayUnchangedAndOwnOnesAreReused) {
  const Extent extent{40, 9};
  const Pixels pixels = random_pixels(extent, 4);
  Layers frame = layers(extent, pixels);
  record(frame, {});
  EXPECT_EQ(download(frame[Role::model]), pixels);
  const Plane* first = frame[Role::intrinsic].get();
  record(frame, {});
  EXPECT_EQ(frame[Role::intrinsic].get(), first);
  const Layers branch = frame;
  const Pixels twice = download(branch[Role::intrinsic]);
  record(frame, {});
  EXPECT_NE(frame[Role::intrinsic], branch[Role::intrinsic]);
  EXPECT_EQ(download(branch[Role::intrinsic]), twice);
}

}  // namespace inverse::testing
