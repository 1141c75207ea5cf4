// SPDX-License-Identifier: LGPL-2.1-or-later
// Every setting of the methods of intrinsicdecomp and globalintrinsic changes what comes out.
#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/elements/element_test.hpp"

namespace inverse::testing {
namespace {

constexpr int kWidth = 160, kHeight = 120, kFrames = 44;
const std::string kCaps = VideoHarness::caps("RGBA64_LE", kWidth, kHeight);

/// An opaque frame whose channels are `value(x, y, channel)`, 0…1.
template <typename Value>
std::vector<uint8_t> draw16(Value value) {
  std::vector<uint8_t> bytes;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 4; ++c) {
        const double level = c == 3 ? 1.0 : std::clamp<double>(value(x, y, c), 0, 1);
        const auto code = static_cast<unsigned>(65535 * level);
        bytes.push_back(static_cast<uint8_t>(code & 255U));
        bytes.push_back(static_cast<uint8_t>(code >> 8U));
      }
  return bytes;
}

/// Colored tiles in uneven light. Up to frame 15 the camera pans, with noise; up to 23 light fades;
/// after a cut to gray tiles a small thing moves, up to 36, and that picture is repeated.
std::vector<uint8_t> frame_at(int t) {
  t = std::min(t, 36);
  std::mt19937 random(static_cast<unsigned>(t));
  std::uniform_real_distribution<double> noise(-0.01, 0.01);
  const bool second = t >= 24;
  return draw16([&](int x, int y, int c) {
    const int tile =
        second ? (x / 5) * 31 + (y / 9) * 17 : ((x + std::min(t, 15)) / 8) * 7 + (y / 8) * 13;
    const double light = second ? 0.4 + 0.4 * y / kHeight
                                : (0.3 + 0.6 * x / kWidth) * (1 - 0.05 * std::max(t - 15, 0));
    const bool thing = second && std::abs(x + 16 - t) < 4 && y / 8 == 3;
    const double paint = thing ? 0.2 + 0.3 * c : 0.15 + 0.1 * ((tile * (c + 3)) % 8);
    return paint * light + (second ? 0 : noise(random));
  });
}

/// A gray ramp.
std::vector<uint8_t> ramp_at(int /*t*/) {
  return draw16([](int x, int y, int) { return (25 + x + y / 4) / 255.0; });
}

using Frames = std::vector<std::vector<uint8_t>>;

Frames frames_of(const std::string& line, std::vector<uint8_t> (*picture)(int) = frame_at) {
  VideoHarness harness(line, kCaps, kCaps);
  Frames frames;
  for (int t = 0; t < kFrames; ++t) frames.push_back(harness.process(picture(t)));
  EXPECT_TRUE(harness.warnings().empty()) << line;
  return frames;
}

std::string name_of(const std::string& setting) { return setting.substr(0, setting.find('=')); }

/// Names of the entries of an element's `tuning`, from its description.
std::set<std::string> tuning_of(const char* factory) {
  GstElement* element = gst_element_factory_make(factory, nullptr);
  std::istringstream lines(
      gst_element_class_get_metadata(GST_ELEMENT_GET_CLASS(element), "Tuning"));
  std::set<std::string> names;
  for (std::string line; std::getline(lines, line);) names.insert(line.substr(0, line.find(':')));
  gst_object_unref(element);
  return names;
}

const std::vector<std::string> kProperties = {
    "light-color-slope=0.5", "reflectance-weight=2", "shading-weight=2", "temporal-weight=3",
    "temporal-hold=0.3",     "white-level=0.5",      "skip-error=0"};
const std::vector<std::string> kTuning = {"cycles=1",
                                          "warm-cycles=1",
                                          "half-resolution=true",
                                          "value-weight=3",
                                          "chroma-weight=0.2",
                                          "white-quantile=0.5",
                                          "temporal-frames=1",
                                          "temporal-motion=0.05",
                                          "temporal-chroma=0.01",
                                          "temporal-detail=1",
                                          "temporal-texture=0.01",
                                          "temporal-hold-light=1",
                                          "cut-fraction=1",
                                          "temporal-hold-texture=2",
                                          "cycle-tolerance=0.5",
                                          "edge-tolerance=1",
                                          "gate-tolerance=1",
                                          "half-tolerance=1",
                                          "repeat-tolerance=0.1"};
const std::vector<std::string> kLight = {
    "typical-amount=2", "measurement-weight=0", "white-balance=1", "base-colors=1",
    "reach=0.05",       "near-share=0",         "update-rate=1",   "cut-chroma=1"};

}  // namespace

TEST(Effect, EverySettingOfIntrinsicdecompChangesFrames) {
  const Frames usual = frames_of("intrinsicdecomp");
  std::set<std::string> names;
  for (const std::string& setting : kProperties)
    EXPECT_TRUE(frames_of("intrinsicdecomp " + setting) != usual) << setting;
  for (const std::string& setting : kTuning) {
    EXPECT_TRUE(frames_of("intrinsicdecomp tuning=" + setting) != usual) << setting;
    names.insert(name_of(setting));
  }
  const std::string half = "intrinsicdecomp tuning=half-resolution=true";
  EXPECT_TRUE(frames_of(half + ":quarter-resolution=true") != frames_of(half));
  names.insert("quarter-resolution");
  EXPECT_TRUE(frames_of("intrinsicdecomp tuning=chroma-tolerance=1", ramp_at) !=
              frames_of("intrinsicdecomp", ramp_at));
  names.insert("chroma-tolerance");
  names.insert("depth-weight");  // needs depth: Scene.SurfacesTellPaintFromShading
  EXPECT_EQ(names, tuning_of("intrinsicdecomp")) << "a new entry needs a line here";
}

TEST(Effect, EverySettingOfGlobalintrinsicChangesFrames) {
  const Frames usual = frames_of("globalintrinsic");
  std::set<std::string> names = tuning_of("intrinsicdecomp");
  EXPECT_TRUE(frames_of("globalintrinsic amount=2") != usual);
  for (const std::string& setting : kLight) {
    EXPECT_TRUE(frames_of("globalintrinsic tuning=" + setting) != usual) << setting;
    names.insert(name_of(setting));
  }
  EXPECT_EQ(names, tuning_of("globalintrinsic")) << "a new entry needs a line here";
}

}  // namespace inverse::testing
