// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsickey: what it sends downstream, and what its settings do.
#include <cmath>

#include "tests/elements/edit/edit_fixture.hpp"
#include "tests/elements/layer_of.hpp"

namespace inverse::testing {
namespace {

constexpr int kWidth = 96, kHeight = 64;

std::string rgba() { return VideoHarness::caps("RGBA", kWidth, kHeight); }
std::string gray() { return VideoHarness::caps("GRAY8", kWidth, kHeight); }

/// How much of a pixel the foreground covers: a disk.
double cover(int x, int y) { return std::clamp((22 - std::hypot(x - 48, y - 34)) / 5, 0.0, 1.0); }

/// RGBA: a gray disk with wide soft edges before a screen, green or blue, under light that falls to
/// one side.
std::vector<uint8_t> keyed_frame(bool blue = false, unsigned seed = 1) {
  std::mt19937 random(seed);
  return draw(kWidth, kHeight, [&](int x, int y, int c) {
    const double paint[2][3] = {{.05, .34, .09}, {.04, .1, .38}};
    const double light = 1 - .4 * x / kWidth;
    const double seen = cover(x, y) * .3 + (1 - cover(x, y)) * light * paint[blue ? 1 : 0][c];
    const int noise = static_cast<int>(random() % 3) - 1;
    return std::clamp(static_cast<int>(std::lround(255 * std::pow(seen, 1 / 2.2))) + noise, 0, 255);
  });
}

class KeyElement : public ::testing::Test {
 protected:
  const std::vector<uint8_t> frame = keyed_frame();
};

/// Mean error of alpha, of 0…255.
double alpha_error(const std::vector<uint8_t>& picture) {
  double sum = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      sum += std::abs(pixel_at(picture, x, y, kWidth)[3] - 255 * cover(x, y));
  return sum / (kWidth * kHeight);
}

}  // namespace

TEST_F(KeyElement, SendsPicturesWithAlphaAndWithoutTheScreensLight) {
  for (const std::string decomposer : {"intrinsicdecomp", "globalintrinsic"})
    for (const bool blue : {false, true}) {
      VideoHarness harness(
          decomposer + " ! intrinsickey key=" + (blue ? "0xff2040c0" : "0xff20c040"), rgba(),
          rgba());
      const auto picture = harness.process(keyed_frame(blue), 3);
      EXPECT_LT(alpha_error(picture), 4) << decomposer << blue;
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
          if (const uint8_t* p = pixel_at(picture, x, y, kWidth); p[3] > 128) {
            ASSERT_NEAR(p[1], p[0], 12) << x << ", " << y;
            ASSERT_NEAR(p[2], p[0], 12) << x << ", " << y;
          }
    }
}

TEST_F(KeyElement, TheMaskIsAlphaForEditorsAndForShow) {
  VideoHarness pictures("intrinsicdecomp ! intrinsickey", rgba(), rgba());
  const auto alpha = pictures.process(frame, 3);
  VideoHarness composed("intrinsicdecomp ! intrinsickey ! intrinsiccompose show=mask", rgba(),
                        VideoHarness::caps("GRAY16_LE", kWidth, kHeight));
  VideoHarness shown("intrinsicdecomp ! intrinsickey show=mask", rgba(),
                     VideoHarness::caps("GRAY16_LE", kWidth, kHeight));
  const auto mask = composed.process(frame, 3);
  EXPECT_EQ(shown.process(frame, 3), mask);
  for (int n = 0; n < kWidth * kHeight; ++n) {
    const double code = (mask[2 * n] + 256 * mask[2 * n + 1]) / 65535.;
    const double light = code <= .04045 ? code / 12.92 : std::pow((code + .055) / 1.055, 2.4);
    ASSERT_NEAR(255 * light, alpha[4 * n + 3], 1.5) << n;
  }
  // Later editors take it: the disk changes, the screen does not.
  VideoHarness edited(
      "intrinsicdecomp ! intrinsickey ! intrinsictone look=metal ! intrinsiccompose", rgba(),
      rgba());
  const auto toned = edited.process(frame, 3);
  EXPECT_GT(std::abs(pixel_at(toned, 48, 20, kWidth)[1] - pixel_at(frame, 48, 20, kWidth)[1]) +
                std::abs(pixel_at(toned, 30, 34, kWidth)[1] - pixel_at(frame, 30, 34, kWidth)[1]),
            2);
  EXPECT_LE(std::abs(pixel_at(toned, 4, 4, kWidth)[1] - pixel_at(frame, 4, 4, kWidth)[1]), 1);
}

TEST_F(KeyElement, FormatsWithoutAlphaGetTheForegroundOverBlack) {
  const std::string rgb = VideoHarness::caps("RGB", kWidth, kHeight);
  VideoHarness harness("intrinsicdecomp ! intrinsickey", rgba(), rgb);
  const auto picture = visible(rgb, harness.process(frame, 3));
  const auto at = [&](int x, int y) {
    return picture[3 * static_cast<size_t>(y * kWidth + x) + 1];
  };
  EXPECT_LE(at(3, 3), 4);
  EXPECT_NEAR(at(48, 34), pixel_at(frame, 48, 34, kWidth)[1], 12);
}

TEST_F(KeyElement, NegotiatesFormatsWithAlpha) {
  for (const char* format : {"RGBA", "AYUV", "ARGB", "BGRA", "A420", "RGBA64_LE"}) {
    const std::string caps = VideoHarness::caps(format, kWidth, kHeight);
    VideoHarness harness("intrinsicdecomp ! intrinsickey ! video/x-raw,format=" +
                             std::string(format) + " ! videoconvert",
                         rgba(), rgba());
    EXPECT_LT(alpha_error(harness.process(frame, 3)), 5) << format;
    EXPECT_TRUE(harness.errors().empty()) << format;
  }
}

TEST_F(KeyElement, NeutralSettingsReturnTheFrameAndDispatchNothing) {
  VideoHarness layers("intrinsicdecomp ! intrinsickey strength=0 ! intrinsiccompose", rgba(),
                      rgba());
  VideoHarness without("intrinsicdecomp ! intrinsiccompose", rgba(), rgba());
  EXPECT_EQ(layers.process(frame, 3), without.process(frame, 3));
  EXPECT_EQ(dispatches_of(layers, "intrinsickey"), 0U);
  VideoHarness pictures("intrinsicdecomp ! intrinsickey strength=0", rgba(), rgba());
  EXPECT_LE(largest_difference(pictures.process(frame, 3), frame), 1);
}

TEST_F(KeyElement, EveryPropertyTakesEffectWhilePlaying) {
  VideoHarness harness("intrinsicdecomp ! intrinsickey", rgba(), rgba());
  GstElement* key = harness.find("intrinsickey");
  const auto first = harness.process(frame, 4);
  for (const auto& [name, value, neutral] :
       std::vector<std::tuple<const char*, const char*, const char*>>{
           {"key", "0xffc02020", "0xff20c040"},
           {"tolerance", "0.01", "0.25"},
           {"black", "0.4", "0.05"},
           {"white", "0.6", "0.95"},
           {"shrink", "3", "0"},
           {"shrink", "-3", "0"},
           {"strength", "0.5", "1"},
           {"invert", "true", "false"},
           {"show", "mask", "keyed"}}) {
    gst_util_set_object_arg(G_OBJECT(key), name, value);
    EXPECT_GT(largest_difference(harness.process(frame), first), 3) << name << "=" << value;
    gst_util_set_object_arg(G_OBJECT(key), name, neutral);
    EXPECT_LE(largest_difference(harness.process(frame, 2), first), 2) << name;
  }
}

TEST_F(KeyElement, DespillTurnsTheScreensHueGray) {
  // A greenish disk within the gray one.
  auto spilled = frame;
  for (int y = 28; y < 40; ++y)
    for (int x = 42; x < 54; ++x) spilled[4 * static_cast<size_t>(y * kWidth + x) + 1] += 6;
  const auto green = [&](const char* settings) {
    VideoHarness harness(std::string("intrinsicdecomp ! intrinsickey ") + settings, rgba(), rgba());
    const auto picture = harness.process(spilled, 3);
    const uint8_t* p = pixel_at(picture, 48, 34, kWidth);
    EXPECT_GT(p[3], 250);
    return p[1] - std::max(p[0], p[2]);
  };
  EXPECT_LE(green("despill=1"), 1);
  EXPECT_GE(green("despill=0"), 3);
}

TEST_F(KeyElement, TheHueOfTheBorderCanBeTheKey) {
  for (const bool blue : {false, true}) {
    VideoHarness harness("intrinsicdecomp ! intrinsickey key=0", rgba(), rgba());
    EXPECT_LT(alpha_error(harness.process(keyed_frame(blue), 3)), 4) << blue;
    EXPECT_TRUE(harness.warnings().empty());
  }
}

TEST_F(KeyElement, AClickSetsTheKey) {
  VideoHarness harness("intrinsicdecomp ! intrinsickey pick=true", rgba(), rgba());
  const auto blue = keyed_frame(true);
  harness.process(blue, 2);
  harness.send_upstream(
      gst_navigation_event_new_mouse_button_press(1, 5, 5, GST_NAVIGATION_MODIFIER_NONE));
  const auto picture = harness.process(blue, 4);
  EXPECT_NE(property<guint>(harness.find("intrinsickey"), "key"), 0xff20c040);
  EXPECT_LT(alpha_error(picture), 4);
  for (const std::string& warning : harness.warnings())
    EXPECT_NE(warning.find("#20c040"), std::string::npos) << "of the color before: " << warning;
}

TEST_F(KeyElement, AMaskConfinesIt) {
  VideoHarness harness(
      "intrinsicdecomp ! intrinsicrecolor key=0xff909090 tolerance=4.25 strength=0 write-mask=true "
      "! "
      "intrinsickey strength=1 use-mask=true",
      rgba(), rgba());
  EXPECT_LT(alpha_error(harness.process(frame, 3)), 8) << "all is selected";
}

TEST_F(KeyElement, FramesWithoutAScreenAreForegroundAndCauseOneWarning) {
  VideoHarness harness("intrinsicdecomp ! intrinsickey", gray(), rgba());
  const auto picture = harness.process(random_frame(gray(), 1), 8);
  for (size_t i = 3; i < picture.size(); i += 4) ASSERT_EQ(picture[i], 255);
  const auto warnings = harness.warnings();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("set key"), std::string::npos) << warnings[0];
}

TEST_F(KeyElement, DoesNotFlicker) {
  VideoHarness harness("intrinsicdecomp ! intrinsickey", rgba(), rgba());
  std::vector<uint8_t> before;
  double sum = 0;
  for (unsigned n = 0; n < 10; ++n) {
    const auto picture = harness.process(keyed_frame(false, n));
    if (n > 3)
      for (size_t i = 3; i < picture.size(); i += 4)
        sum += (picture[i] - before[i]) * (picture[i] - before[i]);
    before = picture;
  }
  EXPECT_LT(std::sqrt(sum / (6.0 * kWidth * kHeight)), 3) << "noise of a code is 1 % of the screen";
}

TEST_F(KeyElement, AnyFormatAndSizeWorks) {
  for (const char* settings : {"", "key=0 shrink=2.5 invert=true"})
    expect_any_format_and_size(std::string("intrinsicdecomp ! intrinsickey ") + settings);
}

TEST_F(KeyElement, WithoutADecomposerItSaysWhatToInsert) {
  VideoHarness harness("intrinsickey", rgba(), rgba());
  harness.push(frame);
  const auto errors = harness.errors();
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_NE(errors[0].find("insert intrinsicdecomp"), std::string::npos) << errors[0];
}

}  // namespace inverse::testing
