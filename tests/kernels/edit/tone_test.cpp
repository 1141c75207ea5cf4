// SPDX-License-Identifier: LGPL-2.1-or-later
// Tone curves: how they are read and interpolated, and the kernels against their specification.
#include "kernels/edit/tone/tone.hpp"

#include <array>
#include <cmath>

#include "tests/expect_error.hpp"
#include "tests/kernels/edit/edit_fixture.hpp"
#include "tests/reference/edit/tone.hpp"

namespace inverse::testing {
namespace {

/// Identity-like, steep, level, falling, and 16 points at random.
const std::vector<std::string> kCurves{
    "-3,-3 0,1 3,3",
    "-5,-4.6 -3,-2.2 -1.5,-1.2 -0.5,-1.3 0.5,-0.6 1.2,-0.1 2,0.1",
    "-1,2 1,-2",
    "-1,0 1,0",
    "0,-20 .002,20",
    "-20,20 20,-20",
    "-7,1 -6,-2 -5,3 -4,0 -3,-1 -2,-1 -1,-.5 0,2 1,1 2,1 3,0 4,5 5,4 6,7 7,-3 8,0",
};

std::vector<reference::TonePoint> reference_of(const ToneCurve& curve) {
  std::vector<reference::TonePoint> points;
  for (const auto& [x, y] : curve) points.push_back({x, y});
  return points;
}

std::vector<double> matte_of(const Pixels& pixels) {
  std::vector<double> matte;
  for (size_t n = 0; n < pixels.size(); n += 4) matte.push_back(double{pixels[n]});
  return matte;
}

}  // namespace

TEST(ToneCurve, ReadsPointsInAnyOrder) {
  EXPECT_TRUE(parse_curve("").empty());
  EXPECT_TRUE(parse_curve(" \n\t ").empty());
  const ToneCurve expected{{-3, -2.5F}, {0, 0}, {1.5F, 2}};
  EXPECT_EQ(parse_curve("-3,-2.5 0,0 1.5,2"), expected);
  EXPECT_EQ(parse_curve("\t1.5,2\n -3,-2.5   0,0 "), expected);
  EXPECT_EQ(parse_curve("1.5:2/-3:-2.5/0:0"), expected);
  EXPECT_EQ(parse_curve("-20,20 20,-20"), (ToneCurve{{-20, 20}, {20, -20}}));
}

TEST(ToneCurve, SaysWhatIsWrong) {
  const auto what = [](const std::string& text) {
    try {
      parse_curve(text);
      return std::string();
    } catch (const Error& error) {
      return std::string(error.what());
    }
  };
  for (const auto& [text, part] : std::vector<std::pair<std::string, std::string>>{
           {"0,0", "one point"},
           {"0,0 1", "point 2 has no y"},
           {"0,0 1 2", "point 2 has no y"},
           {"0,0 1,", "no number"},
           {"0,0 1,2,3", "space behind point 2"},
           {"0,0;1,1", "space behind point 1"},
           {"nan,0 1,1", "no number from -20 to 20 at character 1"},
           {"0,inf 1,1", "no number"},
           {"0,0 1,-nan", "no number"},
           {"0,0 21,1", "no number from -20 to 20 at character 5"},
           {"0,0 1,1e30", "no number"},
           {"0,0 1,1e999", "no number"},
           {"a,0 1,1", "no number"},
           {"0,0 1,1 0,2", "two points at x=0"},
           {"0,0 .0005,1", "two points"}}) {
    EXPECT_NE(what(text).find(part), std::string::npos) << text << ": " << what(text);
  }
  std::string many;
  for (int i = 0; i < 17; ++i) many += std::to_string(i) + "," + std::to_string(i) + " ";
  EXPECT_NE(what(many).find("more than 16 points"), std::string::npos);
  EXPECT_NE(what(std::string(1 << 20, '1')).find("no number"), std::string::npos);
}

TEST(ToneCurve, StraightPointsAreTheIdentityAndOthersAreNot) {
  EXPECT_TRUE(is_identity(parse_curve("")));
  EXPECT_TRUE(is_identity(parse_curve("-3,-3 2,2 0,0")));
  EXPECT_FALSE(is_identity(parse_curve("-3,-3 2,2.01")));
}

// Fritsch and Carlson's property: between two points the curve stays between their values.
TEST(ToneCurve, TheSpecificationNeverOvershoots) {
  for (const std::string& text : kCurves) {
    const auto points = reference_of(parse_curve(text));
    for (size_t i = 0; i + 1 < points.size(); ++i)
      for (int step = 0; step <= 50; ++step) {
        const double x = points[i].x + step / 50.0 * (points[i + 1].x - points[i].x);
        const double y = reference::tone_curve(points, x);
        EXPECT_GE(y, std::min(points[i].y, points[i + 1].y) - 1e-9) << text << " at " << x;
        EXPECT_LE(y, std::max(points[i].y, points[i + 1].y) + 1e-9) << text << " at " << x;
      }
    for (const auto& [x, y] : points) EXPECT_NEAR(reference::tone_curve(points, x), y, 1e-9);
  }
}

class ToneTest : public EditorTest {
 protected:
  Pixels record(Tone& tone, Layers& layers, const ToneParams& params) {
    run([&](gpu::Commands& commands) { tone.record(commands, layers, params); });
    return download(layers[Role::intrinsic]);
  }
  /// Compares in stops, where a curve is steep by what the input's rounding becomes.
  static void expect_shading(const Pixels& got, const Pixels& from,
                             const std::vector<double>& matte, const ToneParams& params,
                             double log2_middle, const std::string& what) {
    const auto points = reference_of(params.curve);
    for (size_t n = 0; n < got.size() / 4; ++n) {
      const double share =
          params.strength * (matte.empty() ? 1 : std::min(reference::finite(matte[n]), 1.0));
      const auto shift = [&](double off) {
        return reference::tone(pixel_of(from, n), share, points, log2_middle + off);
      };
      const reference::Rgba expected = shift(0);
      for (size_t c = 0; c < 3; ++c) ASSERT_EQ(double{got[4 * n + c]}, expected[c]) << what << n;
      ASSERT_TRUE(std::isfinite(got[4 * n + 3])) << what << n;
      const auto stops = [](double s) { return std::log2(std::max(s, 1e-30)); };
      const double slack = std::abs(stops(shift(1e-5)[3]) - stops(shift(-1e-5)[3])) + 2e-4;
      ASSERT_NEAR(stops(double{got[4 * n + 3]}), stops(expected[3]), slack)
          << what << ", pixel " << n << ", S = " << from[4 * n + 3];
    }
  }
};

TEST_F(ToneTest, AgreesWithReference) {
  for (const Extent extent : kOddSizes)
    for (const std::string& text : kCurves)
      for (const float strength : {1.F, .3F}) {
        if (extent.pixels() > 5000 && text != kCurves.back()) continue;
        const Pixels pixels = layers_over_24_stops(extent, extent.width);
        Layers frame = layers(extent, pixels);
        Tone tone(device, extent);
        const ToneParams params{
            .curve = parse_curve(text), .middle = .4F, .strength = strength, .use_mask = true};
        const Pixels got = record(tone, frame, params);
        ASSERT_NO_FATAL_FAILURE(expect_shading(got, pixels, {}, params, std::log2(double{.4F}),
                                               name_of(extent) + " " + text));
      }
}

TEST_F(ToneTest, MaskMultipliesTheChangeInStops) {
  const Extent extent{37, 11};
  const Pixels pixels = layers_over_24_stops(extent, 3), matte = layers_over_24_stops(extent, 4);
  for (const bool use_mask : {true, false}) {
    Layers frame = layers(extent, pixels);
    frame[Role::mask] = shared_plane(extent, matte);
    Tone tone(device, extent);
    const ToneParams params{.curve = parse_curve(kCurves[1]), .middle = 1, .use_mask = use_mask};
    const Pixels got = record(tone, frame, params);
    expect_shading(got, pixels, use_mask ? matte_of(matte) : std::vector<double>(), params, 0,
                   "mask");
  }
}

TEST_F(ToneTest, MiddleIsThatOfWhatTheMaskSelectsAndFollows) {
  for (const Extent extent : kOddSizes) {
    Tone tone(device, extent);
    reference::ToneLevel level;
    const ToneParams params{.curve = parse_curve(kCurves[1])};
    // Of the frames, the fourth is twice as bright as the third, and the fifth 16 times.
    const std::array<float, 6> gains{1, 1.2F, 1.1F, 2.1F, 30, 31};
    for (size_t t = 0; t < gains.size(); ++t) {
      Pixels pixels = layers_over_24_stops(extent, 7), matte = random_pixels(extent, 8);
      for (float& p : pixels) p *= gains[t];
      Layers frame = layers(extent, pixels);
      const bool masked = t > 1;
      if (masked) frame[Role::mask] = shared_plane(extent, matte);
      const auto weights = masked ? matte_of(matte) : std::vector<double>();
      level = reference::follow(
          level, reference::tone_level(reference_of(pixels), weights, extent.width, extent.height));
      const Pixels got = record(tone, frame, params);
      ASSERT_NO_FATAL_FAILURE(expect_shading(got, pixels, weights, params, level.log2_middle,
                                             name_of(extent) + ", frame " + std::to_string(t)));
    }
    // After a reset, the first frame counts alone.
    tone.reset();
    const Pixels pixels = layers_over_24_stops(extent, 9);
    Layers frame = layers(extent, pixels);
    const auto alone = reference::tone_level(reference_of(pixels), {}, extent.width, extent.height);
    ASSERT_NO_FATAL_FAILURE(expect_shading(record(tone, frame, params), pixels, {}, params,
                                           alone.log2_middle, name_of(extent) + ", reset"));
  }
}

// The curve's middle moves with the scale of S, so that the edit does not depend on it.
TEST_F(ToneTest, AnotherExposureIsTheSameEdit) {
  const Extent extent{64, 48};
  Pixels pixels = random_pixels(extent, 1, .1F, 1.F), brighter = pixels;
  for (size_t i = 3; i < pixels.size(); i += 4) brighter[i] *= 3;
  const ToneParams params{.curve = parse_curve(kCurves[1])};
  Layers one = layers(extent, pixels), other = layers(extent, brighter);
  Tone first(device, extent), second(device, extent);
  const Pixels a = record(first, one, params), b = record(second, other, params);
  for (size_t i = 3; i < a.size(); i += 4) ASSERT_NEAR(b[i], 3 * a[i], 1e-4 * b[i]);
}

TEST_F(ToneTest, NeutralSettingsRecordNothing) {
  const Extent extent{16, 16};
  Layers frame = layers(extent, random_pixels(extent, 3));
  const Layers before = frame;
  Tone tone(device, extent);
  for (const ToneParams& params : {ToneParams{}, ToneParams{.curve = parse_curve("-1,-1 5,5")},
                                   ToneParams{.curve = parse_curve(kCurves[0]), .strength = 0},
                                   ToneParams{.curve = parse_curve(kCurves[0]), .strength = kNan}})
    run([&](gpu::Commands& commands) {
      tone.record(commands, frame, params);
      EXPECT_EQ(commands.dispatches(), 0u);
    });
  EXPECT_EQ(frame.planes, before.planes);
}

TEST_F(ToneTest, SharedPlanesStayUnchangedAndOwnOnesAreReused) {
  const Extent extent{40, 9};
  const Pixels pixels = random_pixels(extent, 4);
  Layers frame = layers(extent, pixels);
  Tone tone(device, extent);
  const ToneParams params{.curve = parse_curve("-4,-3 4,5"), .middle = 1};  // twice as bright
  const Pixels once = record(tone, frame, params);
  EXPECT_EQ(download(frame[Role::model]), pixels);
  const Plane* first = frame[Role::intrinsic].get();
  const Pixels twice = record(tone, frame, params);
  EXPECT_EQ(frame[Role::intrinsic].get(), first);
  for (size_t i = 3; i < pixels.size(); i += 4) ASSERT_NEAR(twice[i], 4 * pixels[i], 1e-4);
  const Layers branch = frame;
  record(tone, frame, params);
  EXPECT_NE(frame[Role::intrinsic], branch[Role::intrinsic]);
  EXPECT_EQ(download(branch[Role::intrinsic]), twice);
}

}  // namespace inverse::testing
