// SPDX-License-Identifier: LGPL-2.1-or-later
// Light with layers of its own through the editors: what each shows, changes and refuses. The
// layers are made by hand, through the installed header.
#include <gst/video/navigation.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "tests/elements/draw.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/elements/layer_of.hpp"
#include "tests/srgb.hpp"

namespace inverse::testing {
namespace {

constexpr int kWidth = 24, kHeight = 10;
constexpr const char* kGlobal =
    "video/x-raw(meta:InverseLayers), format=RGBA, layers=(string)global, width=24, height=10, "
    "framerate=25/1";

using Pixel = std::array<float, 4>;

/// What every pixel of the frame is made of: gray paint under white direct light, and light that
/// bounced off a green and a red surface.
constexpr Pixel kPaint{0.5F, 0.5F, 0.5F, 0.8F};
constexpr Pixel kGreenBase{0.1F, 1, 0.1F, 1}, kRedBase{1, 0.2F, 0.2F, 1};
constexpr float kDirect = 0.6F, kFromGreen = 0.3F, kFromRed = 0.2F;

Pixel light_of(float green, float red) {
  Pixel light{};
  for (size_t c = 0; c < 3; ++c) light[c] = kDirect + green * kGreenBase[c] + red * kRedBase[c];
  light[3] = kDirect;
  return light;
}

int srgb(double linear) {
  return static_cast<int>(std::lround(255 * std::min(srgb_code(linear), 1.0)));
}

void put(GstBuffer* buffer, GstInverseRole role, const std::vector<Pixel>& pixels) {
  const float* values = pixels.front().data();
  ASSERT_TRUE(replace_layer(buffer, role, {values, values + 4 * pixels.size()})) << role;
}

/// A line of editors that gets the frame above.
class LightOf : public ::testing::Test {
 protected:
  /// The pixel in the middle that comes out of a line (RGBA), or nothing.
  std::vector<int> through(const std::string& line, GstFlowReturn expected = GST_FLOW_OK) {
    const std::string caps = VideoHarness::caps("RGBA", kWidth, kHeight);
    VideoHarness source("intrinsicdecomp", caps, kLayers);
    GstBuffer* buffer =
        gst_buffer_make_writable(source.process_buffer(flat_frame(caps, 128)).release());
    const std::vector<Pixel> paint(kWidth * kHeight, kPaint);
    const std::vector<Pixel> light(kWidth * kHeight, light_of(kFromGreen, kFromRed));
    Pixel input = light.front();
    for (size_t c = 0; c < 3; ++c) input[c] *= kPaint[c] * kPaint[3];
    input[3] = 1;
    std::vector<Pixel> bases(16, Pixel{});
    bases[0] = kGreenBase;
    bases[5] = kRedBase;
    put(buffer, GST_INVERSE_ROLE_INPUT, std::vector<Pixel>(kWidth * kHeight, input));
    put(buffer, GST_INVERSE_ROLE_MODEL, paint);
    put(buffer, GST_INVERSE_ROLE_INTRINSIC, paint);
    put(buffer, GST_INVERSE_ROLE_MODEL_LIGHT, light);
    put(buffer, GST_INVERSE_ROLE_LIGHT, light);
    put(buffer, GST_INVERSE_ROLE_INDIRECT_0,
        std::vector<Pixel>(kWidth * kHeight, Pixel{kFromGreen, 0, 0, 0}));
    put(buffer, GST_INVERSE_ROLE_INDIRECT_1,
        std::vector<Pixel>(kWidth * kHeight, Pixel{0, kFromRed, 0, 0}));
    put(buffer, GST_INVERSE_ROLE_BASES, bases);
    VideoHarness editors(line, kGlobal, caps);
    EXPECT_EQ(gst_harness_push(editors.harness(), buffer), expected);
    errors_ = editors.errors();
    if (expected != GST_FLOW_OK) return {};
    const Buffer made(gst_harness_try_pull(editors.harness()));
    if (!made) return {};
    const auto bytes = bytes_of(made.get());
    const uint8_t* middle = &bytes[4 * (kWidth * (kHeight / 2) + kWidth / 2)];
    return {middle[0], middle[1], middle[2]};
  }
  /// Linear light, drawn.
  static std::vector<int> drawn(const Pixel& linear, double gain = 1) {
    return {srgb(linear[0] * gain), srgb(linear[1] * gain), srgb(linear[2] * gain)};
  }
  static void expect_near(const std::vector<int>& got, const std::vector<int>& wanted,
                          const std::string& what) {
    ASSERT_EQ(got.size(), 3u) << what;
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(got[c], wanted[c], 1) << what << ", channel " << c;
  }
  std::vector<std::string> errors_;
};

TEST_F(LightOf, ComposeShowsEveryLayer) {
  const double s = kPaint[3];
  expect_near(through("intrinsiccompose"), drawn(light_of(kFromGreen, kFromRed), s * 0.5), "all");
  expect_near(through("intrinsiccompose residual=none"),
              drawn(light_of(kFromGreen, kFromRed), s * 0.5), "model");
  expect_near(through("intrinsiccompose show=shading"),
              drawn(light_of(kFromGreen, kFromRed), s * 0.5), "shading");
  expect_near(through("intrinsiccompose shading-scale=1 show=direct"),
              drawn({kDirect, kDirect, kDirect}, s), "direct");
  Pixel indirect = light_of(kFromGreen, kFromRed);
  for (size_t c = 0; c < 3; ++c) indirect[c] -= kDirect;
  expect_near(through("intrinsiccompose shading-scale=1 show=indirect"), drawn(indirect, s),
              "indirect");
  expect_near(through("intrinsiccompose shading-scale=1 show=layer layer=0"),
              drawn(kGreenBase, s * kFromGreen), "green");
  expect_near(through("intrinsiccompose shading-scale=1 show=layer layer=5"),
              drawn(kRedBase, s * kFromRed), "red");
  expect_near(through("intrinsiccompose shading-scale=1 show=layer layer=9"), {0, 0, 0}, "none");
}

TEST_F(LightOf, DespillTakesOneColorOfLightAway) {
  const double s = 0.5 * kPaint[3];
  expect_near(through("intrinsicdespill key=0xff20ff20 keep=0 ! intrinsiccompose"),
              drawn(light_of(0, kFromRed), s), "by key");
  expect_near(through("intrinsicdespill layer=5 keep=0 ! intrinsiccompose"),
              drawn(light_of(kFromGreen, 0), s), "by layer");
  expect_near(through("intrinsicdespill layer=5 keep=0 ! intrinsicdespill layer=0 keep=0 ! "
                      "intrinsiccompose residual=none"),
              drawn(light_of(0, 0), s), "both");
  Pixel neutral = light_of(0, kFromRed);
  for (size_t c = 0; c < 3; ++c) neutral[c] += kFromGreen * 0.4F;  // the mean of the green base
  expect_near(through("intrinsicdespill key=0xff20ff20 ! intrinsiccompose"), drawn(neutral, s),
              "made neutral");
  expect_near(through("intrinsicdespill key=0xff2020ff ! intrinsiccompose"),
              drawn(light_of(kFromGreen, kFromRed), s), "no such color");
  expect_near(through("intrinsicdespill strength=0 ! intrinsiccompose"),
              drawn(light_of(kFromGreen, kFromRed), s), "off");
}

TEST_F(LightOf, RecolorPreservesLightOfOtherSurfaces) {
  // No surface of the frame is red: nothing is selected, so no light turns.
  expect_near(through("intrinsicrecolor key=0xffff4040 target=0xff4040ff ! intrinsiccompose"),
              drawn(light_of(kFromGreen, kFromRed), 0.5 * kPaint[3]), "nothing selected");
}

TEST_F(LightOf, SplitSendsEveryLayer) {
  const auto split = [&](const std::string& pad) {
    return through("intrinsicsplit name=s shading-scale=1 s." + pad + " ! identity");
  };
  expect_near(split("indirect_5"), drawn(kRedBase, kPaint[3] * kFromRed), "indirect_5");
  expect_near(split("shading"), drawn(light_of(kFromGreen, kFromRed), kPaint[3]), "shading");
}

/// RGBA: a red wall on the left, a green one on the right, white between, lit from above, the white
/// with the walls' color on it.
std::vector<uint8_t> colored_corner(int width, int height) {
  return draw(width, height, [&](int x, int y, int c) {
    const double u = (x + 0.5) / width, v = (y + 0.5) / height, direct = 0.7 - 0.4 * v;
    const bool left = u<0.3, right = u> 0.7;
    const double red = left ? 0.03 : 0.25 * std::exp(-4 * (u - 0.3)),
                 green = right ? 0.03 : 0.25 * std::exp(-4 * (0.7 - u));
    const std::array<double, 3> paint = left    ? std::array{0.75, 0.1, 0.1}
                                        : right ? std::array{0.12, 0.6, 0.12}
                                                : std::array{0.75, 0.75, 0.75};
    const std::array<double, 3> light{direct + red + 0.15 * green, direct + 0.1 * red + green,
                                      direct + 0.1 * red + 0.15 * green};
    const auto channel = static_cast<size_t>(c);
    return srgb(paint[channel] * light[channel]);
  });
}

TEST(GlobalIntrinsic, UneditedChainReturnsItsInput) {
  for (const auto& [format, width, height] :
       {std::tuple{"RGBA", 349, 287}, {"RGB", 15, 10}, {"GRAY8", 33, 1}, {"RGBA", 1, 1}}) {
    const std::string caps = VideoHarness::caps(format, width, height);
    VideoHarness model("globalintrinsic ! intrinsiccompose residual=none", caps, caps);
    VideoHarness whole("globalintrinsic ! intrinsiccompose", caps, caps);
    for (unsigned seed = 0; seed < 2; ++seed) {
      const auto frame = random_frame(caps, seed), pixels = visible(caps, frame);
      EXPECT_LE(largest_difference(visible(caps, whole.process(frame)), pixels), 1) << caps;
      EXPECT_LE(largest_difference(visible(caps, model.process(frame)), pixels), 2) << caps;
    }
  }
}

TEST(GlobalIntrinsic, DespillTakesTheWallsColorOffTheFloor) {
  const int width = 160, height = 120;
  const std::string caps = VideoHarness::caps("RGBA", width, height);
  const auto frame = colored_corner(width, height);
  VideoHarness harness(
      "globalintrinsic light-color-slope=0 ! intrinsicdespill key=0xffe05050 tolerance=1.2 ! "
      "intrinsiccompose",
      caps, caps);
  const auto out = harness.process(frame, 3);
  const size_t by_the_wall = 4 * (size_t(width) * 90 + 54);
  const auto cast = [&](const std::vector<uint8_t>& picture) {
    return double(picture[by_the_wall]) / picture[by_the_wall + 1];
  };
  EXPECT_GT(cast(frame), 1.08);
  EXPECT_NEAR(cast(out), 1, 0.1 * (cast(frame) - 1)) << "red over green";
}

TEST(GlobalIntrinsic, ShowsEveryLayerWhilePlaying) {
  const std::string caps = VideoHarness::caps("RGBA", 64, 48);
  const auto frame = colored_corner(64, 48);
  VideoHarness harness("globalintrinsic name=g shading-scale=1", caps, caps);
  GstElement* element = harness.find("globalintrinsic");
  std::vector<std::vector<uint8_t>> seen;
  for (const char* show :
       {"reflectance", "shading", "input", "mosaic", "clusters", "direct", "indirect", "layer"}) {
    gst_util_set_object_arg(G_OBJECT(element), "show", show);
    for (int k = 0; k < 2; ++k) seen.push_back(harness.process(frame));
    ASSERT_EQ(seen.back().size(), frame.size()) << show;
    if (seen.size() > 2) {
      EXPECT_GT(largest_difference(seen.back(), seen[seen.size() - 3]), 0) << show;
    }
  }
  EXPECT_EQ(seen[4], frame) << "the input";
  // An unchanged picture's layers are computed on request.
  int brightest = 0;
  for (size_t i = 0; i < seen.back().size(); ++i)
    if (i % 4 != 3) brightest = std::max(brightest, int(seen.back()[i]));
  EXPECT_NEAR(brightest, 119, 6);
}

TEST(GlobalIntrinsic, ReportsTheAmountAndAcceptsAGivenOne) {
  const std::string caps = VideoHarness::caps("RGBA", 160, 120);
  VideoHarness harness("globalintrinsic amount=0.33", caps, caps);
  harness.process(colored_corner(160, 120));
  GstElement* element = harness.find("globalintrinsic");
  EXPECT_FLOAT_EQ(stat<double>(element, "amount"), 0.33F);
  EXPECT_EQ(stat<double>(element, "confidence"), 1);
  EXPECT_EQ(stat<guint>(element, "colors"), 3u);
}

/// A field of element messages of this name posted since the last call.
std::vector<int> fields(GstBus* bus, const char* name, const char* key) {
  std::vector<int> values;
  for (const Structure& message : element_messages(bus, name))
    values.push_back(field<int>(message.get(), key).value_or(-1));
  return values;
}

/// Of inverse-region-lost since the last call: region and reason.
std::vector<std::pair<int, std::string>> lost_regions(GstBus* bus) {
  std::vector<std::pair<int, std::string>> lost;
  for (const Structure& message : element_messages(bus, "inverse-region-lost"))
    lost.emplace_back(field<int>(message.get(), "region").value_or(-1),
                      field<std::string>(message.get(), "reason").value_or(""));
  return lost;
}

class GlobalIntrinsicThesis : public ::testing::Test {
 protected:
  static constexpr int kSide = 48;
  void mark(int x, int y) { g_signal_emit_by_name(element_, "mark", x, y); }
  void click(double x, double y) {
    harness_.send_upstream(
        gst_navigation_event_new_mouse_button_press(1, x, y, GST_NAVIGATION_MODIFIER_NONE));
  }
  unsigned regions() { return stat<guint>(element_, "regions"); }

  const std::string caps_ = VideoHarness::caps("RGBA", kSide, kSide);
  const std::vector<uint8_t> frame_ = colored_corner(kSide, kSide);
  VideoHarness harness_{"globalintrinsicthesis tuning=steps=2:keyframes=0", caps_, caps_};
  GstBus* bus_ = harness_.bus();
  GstElement* element_ = harness_.find("globalintrinsicthesis");
};

TEST_F(GlobalIntrinsicThesis, ClicksMarkRegionsAndGetColors) {
  harness_.process(frame_);
  mark(kSide / 2, kSide / 2);
  click(2.7, 30.2);  // on the shown picture, as a sink sends it
  for (int k = 0; k < 3; ++k) harness_.process(frame_);
  EXPECT_EQ(fields(bus_, "inverse-region-marked", "region"), (std::vector{1, 2}));
  EXPECT_EQ(regions(), 2u);
  std::vector<int> corrected;
  for (int k = 0; k < 40 && corrected.empty(); ++k) {
    harness_.process(frame_);
    corrected = fields(bus_, "inverse-region-corrected", "region");
  }
  EXPECT_FALSE(corrected.empty()) << "no region was given a base color";
}

TEST_F(GlobalIntrinsicThesis, ImpossibleClicksAreRefusedWithAMessage) {
  harness_.process(frame_);
  for (const auto& [x, y] : {std::pair{-1, 5}, {5, -1}, {kSide, 5}, {5, kSide}, {1 << 30, 3}})
    mark(x, y);
  harness_.process(frame_);
  EXPECT_EQ(fields(bus_, "inverse-region-marked", "region"), std::vector(5, 0));
  for (int k = 0; k < 500; ++k) mark(k % kSide, k / kSide);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(harness_.process(frame_).size(), frame_.size());
  EXPECT_EQ(fields(bus_, "inverse-region-marked", "region").size(), 500u);
  EXPECT_LE(regions(), 15u);
  harness_.flush();
  EXPECT_EQ(harness_.process(frame_).size(), frame_.size());
  EXPECT_EQ(regions(), 0u) << "a seek forgets what was marked";
}

TEST_F(GlobalIntrinsicThesis, ReportsRemovedRegions) {
  harness_.process(frame_);
  mark(kSide / 2, kSide / 2);
  for (int k = 0; k < 5; ++k) harness_.process(frame_);
  ASSERT_EQ(regions(), 1u);
  g_signal_emit_by_name(element_, "unmark", 7);  // marks nothing
  g_signal_emit_by_name(element_, "unmark", 1);
  harness_.process(frame_);
  EXPECT_EQ(lost_regions(bus_), (std::vector{std::pair{1, std::string("unmarked")}}));
  mark(kSide / 2, kSide / 2);
  for (int k = 0; k < 5; ++k) harness_.process(frame_);
  EXPECT_EQ(regions(), 1u);
  harness_.flush();
  harness_.process(frame_);
  EXPECT_EQ(lost_regions(bus_), (std::vector{std::pair{1, std::string("reset")}}));
}

TEST_F(GlobalIntrinsicThesis, ACutRemovesRegionsAndIsReported) {
  for (int k = 0; k < 3; ++k) harness_.process(frame_);
  mark(kSide / 2, kSide / 2);
  for (int k = 0; k < 5; ++k) harness_.process(frame_);
  ASSERT_EQ(regions(), 1u);
  EXPECT_TRUE(fields(bus_, "inverse-region-lost", "region").empty());
  std::vector<uint8_t> other = frame_;
  for (size_t i = 0; i + 3 < other.size(); i += 4) std::swap(other[i], other[i + 1]);
  int cuts = 0;
  for (int k = 0; k < 12; ++k) {
    harness_.process(other);
    cuts += stat<bool>(element_, "cut");
  }
  EXPECT_EQ(cuts, 1);
  EXPECT_EQ(regions(), 0u);
  EXPECT_EQ(lost_regions(bus_), (std::vector{std::pair{1, std::string("cut")}}));
  // It converges on the new scene: layers of a repeated picture are reused.
  bool reused = false;
  for (int k = 0; k < 100 && !reused; ++k) {
    harness_.process(other);
    reused = stat<bool>(element_, "reused");
  }
  EXPECT_TRUE(reused);
}

TEST_F(GlobalIntrinsicThesis, AFlushDropsClicksThatWait) {
  mark(2, 3);  // before there is any frame
  harness_.process(frame_);
  EXPECT_EQ(fields(bus_, "inverse-region-marked", "x"), std::vector{2});
  mark(5, 5);
  harness_.flush();
  mark(6, 5);
  harness_.process(frame_);
  EXPECT_EQ(fields(bus_, "inverse-region-marked", "x"), std::vector{6});
}

TEST_F(GlobalIntrinsicThesis, ClicksOnTheMosaicMarkThePixelUnderThem) {
  gst_util_set_object_arg(G_OBJECT(element_), "show", "mosaic");
  harness_.process(frame_);
  click(kSide / 2 + 6.3, 2.9);
  click(3, kSide - 1);
  click(std::numeric_limits<double>::quiet_NaN(), 3);
  click(3, -1e300);
  click(1e300, 3);
  mark(30, 7);  // pixels of the frame, whatever is shown
  harness_.process(frame_);
  std::vector<std::array<int, 3>> clicks;
  for (const Structure& message : element_messages(bus_, "inverse-region-marked")) {
    const auto number = [&](const char* name) {
      return field<int>(message.get(), name).value_or(-1);
    };
    clicks.push_back({number("x"), number("y"), number("region")});
  }
  const std::vector<std::array<int, 3>> expected{{12, 4, 1}, {6, kSide - 2, 2}, {-1, 3, 0},
                                                 {3, -1, 0}, {G_MAXINT, 3, 0},  {30, 7, 3}};
  EXPECT_EQ(clicks, expected);
}

TEST(GlobalIntrinsicThesisStreams, MayFollowEachOtherWhileFramesAreInFlight) {
  const std::string source =
      "videotestsrc num-buffers=6 ! video/x-raw,format=RGBA,width=32,height=24 ! c. ";
  const LineResult result = run_line(
      "concat name=c ! globalintrinsicthesis tuning=steps=1 ! "
      "video/x-raw(meta:InverseLayers) ! fakesink " +
      source + source);
  EXPECT_TRUE(result.eos);
  EXPECT_TRUE(result.errors.empty()) << result.first_error();
}

TEST_F(GlobalIntrinsicThesis, CapsMayChangeWhileItRefinesAndCorrects) {
  for (int k = 0; k < 2; ++k) harness_.process(frame_);
  mark(10, 10);
  g_signal_emit_by_name(element_, "refine");
  harness_.process(frame_);
  const std::string small = VideoHarness::caps("RGBA", 20, 16);
  harness_.set_src_caps(small);
  const auto frame = colored_corner(20, 16);
  mark(19, 15);
  for (int k = 0; k < 3; ++k) harness_.process(frame);
  EXPECT_TRUE(harness_.errors().empty());
}

TEST(LightLayers, AreRefusedByNameWhereThereAreNone) {
  for (const auto& [line, element] :
       {std::pair{"intrinsicdecomp ! intrinsicdespill ! intrinsiccompose", "globalintrinsic"},
        {"intrinsicdecomp ! intrinsiccompose shading-scale=1 show=direct", "globalintrinsic"},
        {"intrinsicdecomp ! intrinsicsplit name=s s.indirect", "globalintrinsic"},
        {"intrinsicdespill ! intrinsiccompose", "globalintrinsic"}}) {
    const LineResult result =
        run_line(std::string("videotestsrc num-buffers=2 ! video/x-raw,width=32,height=24 ! ") +
                 line + " ! fakesink");
    ASSERT_FALSE(result.errors.empty()) << line;
    expect_contains(result.first_error(), element);
  }
}

}  // namespace
}  // namespace inverse::testing
