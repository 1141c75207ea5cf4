// SPDX-License-Identifier: LGPL-2.1-or-later
// Tests of the benchmark itself: layers of light through a device, scenes with layers through a
// file, judged photographs, work on all cores.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tests/bench/methods/truth_clicks.hpp"
#include "tests/bench/metrics/png_file.hpp"
#include "tests/bench/peers/peer_despill.hpp"
#include "tests/bench/support/device_session.hpp"
#include "tests/bench/support/photographs.hpp"
#include "tests/bench/support/scene.hpp"
#include "tests/srgb.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::bench {
namespace {

PlanePtr upload(const std::shared_ptr<gpu::Device>& device, Extent extent,
                const std::array<float, 4>& pixel) {
  auto buffer =
      gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels(), gpu::Memory::upload);
  for (std::size_t i = 0; i < extent.pixels(); ++i)
    std::memcpy(buffer->map_as<float>() + 4 * i, pixel.data(), sizeof pixel);
  return std::make_shared<Plane>(Plane{extent, buffer});
}

TEST(DeviceSession, SplitsShadingByItsLight) {
  DeviceSession session("");
  const Extent extent{5, 3};
  const Image frame(5, 3, 3, 0.5F);
  Cost cost;
  const Decomposition d = session.run(
      frame,
      [&](gpu::Commands&, const PlanePtr& input) {
        Layers layers = intrinsic_layers(
            input, upload(session.device(), extent, {0.2F, 0.3F, 0.4F, 2}), nullptr);
        layers[Role::light] = layers[Role::model_light] =
            upload(session.device(), extent, {1.2F, 0.9F, 0.9F, 0.75F});
        return layers;
      },
      cost);
  EXPECT_FLOAT_EQ(d.reflectance.at(4, 2, 2), 0.4F);
  for (const int c : {0, 1, 2}) EXPECT_FLOAT_EQ(d.direct.at(4, 2, c), 1.5F);
  EXPECT_FLOAT_EQ(d.indirect.at(4, 2, 0), 0.9F);
  EXPECT_NEAR(d.indirect.at(4, 2, 1), 0.3F, 1e-6F);
  EXPECT_NEAR(d.shading.at(4, 2), 0.2126F * 2.4F + 0.7874F * 1.8F, 1e-5F);
  const Decomposition plain = session.run(
      frame,
      [&](gpu::Commands&, const PlanePtr& input) {
        return intrinsic_layers(input, upload(session.device(), extent, {0.2F, 0.3F, 0.4F, 2}),
                                nullptr);
      },
      cost);
  EXPECT_TRUE(plain.direct.empty());
  EXPECT_FLOAT_EQ(plain.shading.at(0, 0), 2);
}

TEST(Scenes, ArePlayedToAndFro) {
  std::vector<std::size_t> shown;
  for (std::size_t k = 0; k < 9; ++k) shown.push_back(to_and_fro(k, 4));
  EXPECT_EQ(shown, (std::vector<std::size_t>{0, 1, 2, 3, 2, 1, 0, 1, 2}));
  EXPECT_EQ(to_and_fro(7, 1), 0U);
  EXPECT_EQ(to_and_fro(7, 2), 1U);
}

TEST(Scenes, ComeBackWithTheirLight) {
  const inverse::testing::TemporaryFolder temporary;
  const std::string& folder = temporary.path();
  TruthFrame frame{
      Image(4, 3, 3, 0.5F), Image(4, 3, 3, 0.6F), Image(4, 3, 1, 0.7F), {}, {}, {}, {}};
  Scene scene{"a", "with light", "some regime", false, {frame}};
  scene.frames[0].direct = Image(4, 3, 3, 0.1F);
  scene.frames[0].indirect = Image(4, 3, 3, 0.2F);
  scene.frames[0].id = Image(4, 3, 1, 7);
  write_scene(folder, scene);
  scene.frames[0].id = {};
  scene.name = "without id";
  write_scene(folder, scene);
  write_scene(folder, {"b", "plain", "some regime", true, {frame}});
  const std::vector<Scene> scenes = read_scenes(folder);
  ASSERT_EQ(scenes.size(), 3U);
  EXPECT_EQ(scenes[0].name, "with light");
  EXPECT_FLOAT_EQ(scenes[0].frames[0].direct.at(3, 2, 2), 0.1F);
  EXPECT_FLOAT_EQ(scenes[0].frames[0].indirect.at(3, 2, 0), 0.2F);
  EXPECT_FLOAT_EQ(scenes[0].frames[0].id.at(3, 2), 7);
  EXPECT_TRUE(scenes[1].frames[0].id.empty());
  EXPECT_FALSE(scenes[1].frames[0].direct.empty());
  EXPECT_TRUE(scenes[2].frames[0].direct.empty());
  EXPECT_TRUE(scenes[2].video);
}

/// Reflectance is the frame times a factor.
class Times final : public Solver {
 public:
  explicit Times(float factor) : factor_(factor) {}
  Decomposition run(const Image& frame, bool, Cost&) override {
    Decomposition d{frame, {}};
    for (float& v : d.reflectance.data) v *= factor_;
    return d;
  }

 private:
  float factor_;
};

Method times(const char* family, float factor) {
  Method method{"times", family, "", {}, {}, {}};
  const auto make = [factor](Size) { return std::make_unique<Times>(factor); };
  method.settings.push_back({.curve = "only", .make = make, .effort = Setting::Effort::brief});
  method.settings.push_back({.curve = "other", .make = make});
  return method;
}

/// The left half has a fourth of the right half's light; the points are 1, 1 and 6, 2.
class Photographs : public ::testing::Test {
 protected:
  void write(const std::string& x1, const std::string& darker) const {
    Image picture(8, 4, 3, 0.8F);
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x)
        for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 0.2F;
    write_png(folder_ / "a.png", picture);
    folder_.write("pairs.json", R"({"a.png": [{"x1": )" + x1 + R"(, "y1": 1, "x2": 6, "y2": 2, )" +
                                    R"("darker": ")" + darker + R"("}]})");
  }
  inverse::testing::TemporaryFolder folder_;
};

TEST_F(Photographs, HaveTheRatiosOfTheirPoints) {
  constexpr double kCode = 0.02;  // of 8 bits
  write("1", "1");
  // Elements cut reflectance at 1: .4 and 1.6 become .4 and 1. Other methods' scales are free.
  for (const auto& [family, ratio] : {std::pair{"peer", 0.25}, {"method", 0.4}}) {
    const auto found =
        nlohmann::json::parse(measure_photographs(folder_.path(), {times(family, 2)}, {}));
    ASSERT_EQ(found["rows"].size(), 1U);
    EXPECT_NEAR(found["rows"][0]["ratios"][0].get<double>(), ratio, kCode * ratio) << family;
    EXPECT_EQ(found["pictures"][0]["darker"], "1");
    EXPECT_NEAR(found["pictures"][0]["chroma"][0].get<double>(), 0, 0.1);
  }
}

TEST_F(Photographs, AreRefusedWhereTheirPairsAreNoPairs) {
  write("0", "1");
  EXPECT_THROW(read_photographs(folder_.path()), std::runtime_error);
  write("1", "3");
  EXPECT_THROW(read_photographs(folder_.path()), std::runtime_error);
  write("1", "E");
  EXPECT_EQ(read_photographs(folder_.path()).front().pairs.front().darker,
            Judgment::Darker::neither);
}

TEST(Photograph, ChromaIsThatOfTheMoreColorfulPoint) {
  Image image(7, 3, 3, 0.5F);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 3; ++x) image.at(x, y, 0) = 1, image.at(x, y, 1) = image.at(x, y, 2) = 0;
  EXPECT_NEAR(pair_chroma(image, {5, 1, 1, 1}), 104.55, 0.1);  // sRGB's red
}

Image pixel(float r, float g, float b) {
  Image image(1, 1, 3);
  image.data = {srgb_light(r), srgb_light(g), srgb_light(b)};
  return image;
}
void expect_codes(const Image& found, float r, float g, float b) {
  constexpr float kNear = 1e-4F;
  EXPECT_NEAR(found.data[0], srgb_light(r), kNear);
  EXPECT_NEAR(found.data[1], srgb_light(g), kNear);
  EXPECT_NEAR(found.data[2], srgb_light(b), kNear);
}

TEST(Despill, OfOthersIsWhatTheirFormulasSay) {
  expect_codes(ffmpeg_despill(pixel(0.4F, 0.9F, 0.2F)), 0.4F, 0.3F, 0.2F);
  expect_codes(ffmpeg_despill(pixel(0.4F, 0.2F, 0.2F)), 0.4F, 0.2F, 0.2F);
  expect_codes(green_limit(pixel(0.4F, 0.9F, 0.2F)), 0.4F, 0.4F, 0.2F);
  // The key disappears; a gray with a green cast loses all of the cast and its luma.
  expect_codes(gst_alpha_green(pixel(0, 1, 0)), 0, 0, 0);
  expect_codes(gst_alpha_green(pixel(0.5F, 0.7F, 0.5F)), 0.5F, 0.5F, 0.5F);
  expect_codes(gst_alpha_green(pixel(0.8F, 0.5F, 0.4F)), 0.8F, 0.5F, 0.4F);
}

TEST(InParallel, DoesEverythingOnceAndPassesErrorsOn) {
  std::atomic<int> sum{0};
  in_parallel(100, [&](std::size_t k) { sum += int(k); });
  EXPECT_EQ(sum, 4950);
  in_parallel(0, [](std::size_t) { FAIL(); });
  EXPECT_THROW(in_parallel(3,
                           [](std::size_t k) {
                             if (k == 1) throw std::runtime_error("no");
                           }),
               std::runtime_error);
}

/// Slots 0 red, 1 green and 2 white; white has no layer.
std::vector<BaseColors::Color> three_colors() {
  std::vector<BaseColors::Color> colors(3);
  const float paint[3][3] = {{0.8F, 0.1F, 0.1F}, {0.1F, 0.6F, 0.1F}, {0.5F, 0.5F, 0.5F}};
  for (int k = 0; k < 3; ++k) {
    BaseColors::Color& color = colors[std::size_t(k)];
    color.slot = k, color.layer = k < 2 ? k : -1;
    const auto c = chromaticity(paint[k][0], paint[k][1], paint[k][2]);
    for (std::size_t j = 0; j < 3; ++j) {
      color.center[j] = float(std::log(c[j]));
      color.color[j] = color.initial[j] = paint[k][j];
    }
  }
  return colors;
}

TEST(TruthClicks, PaintFindsItsBaseColor) {
  Image paint(4, 1, 3);
  const float values[4][3] = {{0.4F, 0.05F, 0.05F}, {0.2F, 0.9F, 0.2F}, {0.1F, 0.1F, 0.11F}, {}};
  for (int x = 0; x < 4; ++x)
    for (int c = 0; c < 3; ++c) paint.at(x, 0, c) = values[x][c];
  const TrueSlots all(paint, {}, three_colors());
  EXPECT_EQ(all.nearest(), (std::vector<int>{0, 1, 2, -1}));
  EXPECT_EQ(all.wrong({0, 1, 2, 0}), (std::vector<std::uint8_t>{0, 0, 0, 0}));
  EXPECT_EQ(all.wrong({1, 2, -1, 1}), (std::vector<std::uint8_t>{1, 1, 0, 0}));
  // Masked pixels are unknown.
  Image mask(4, 1, 1);
  mask.at(1, 0, 0) = 1;
  const TrueSlots masked(paint, mask, three_colors());
  EXPECT_EQ(masked.nearest(), (std::vector<int>{-1, 1, -1, -1}));
  EXPECT_EQ(masked.wrong({1, 2, 0, 1}), (std::vector<std::uint8_t>{0, 1, 0, 0}));
}

TEST(TruthClicks, WhatIsHardlyNearerIsNotWrong) {
  // Gray paint, 1 from one base color and a little or clearly more from another.
  std::vector<BaseColors::Color> colors = three_colors();
  colors.resize(2);
  colors[1].center = {-1, 0, 0};
  for (const auto& [more, wrong] : {std::pair{0.05F, 0}, {0.2F, 1}}) {
    colors[0].center = {1 + more, 0, 0};
    const TrueSlots slots(Image(1, 1, 3, 0.5F), {}, colors);
    EXPECT_EQ(slots.nearest()[0], 1);
    EXPECT_EQ(slots.wrong({0})[0], wrong) << more;
  }
}

TEST(TruthClicks, AreOnTheWrongRegionsLargestFirst) {
  // Of 8 x 4 pixels the right half is green and the top left 2 x 2 white; all were assigned to red
  // and the bottom left row to green, which is too small to click on.
  constexpr int kWidth = 8, kHeight = 4;
  std::vector<int> slots(kWidth * kHeight, 0), truth(slots.size(), 0);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const std::size_t n = std::size_t(y * kWidth + x);
      if (x >= 4) truth[n] = 1, slots[n] = 2;
      if (x < 2 && y < 2) truth[n] = 2, slots[n] = 1;
      if (x < 3 && y == 3) slots[n] = 1;
    }
  std::vector<std::uint8_t> wrong(slots.size());
  for (std::size_t n = 0; n < slots.size(); ++n) wrong[n] = slots[n] != truth[n];
  EXPECT_EQ(components(slots, wrong, truth, kWidth, kHeight).size(), 4U);
  const auto found = wrong_components(slots, wrong, truth, kWidth, kHeight, 0.125);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].pixels.size(), 16U);
  EXPECT_EQ(found[0].wrong, 16U);
  EXPECT_EQ(found[0].cluster, 2);
  EXPECT_EQ(found[0].right, 1);
  EXPECT_GE(found[0].click() % kWidth, 4);
  EXPECT_EQ(found[1].pixels.size(), 4U);
  EXPECT_EQ(found[1].right, 2);
  EXPECT_LT(found[1].click() % kWidth, 2);
  EXPECT_LT(found[1].click() / kWidth, 2);
  // With a smaller share the row is large enough; pixels without cluster form no region.
  EXPECT_EQ(wrong_components(slots, wrong, truth, kWidth, kHeight, 0.09).size(), 3U);
  for (int& slot : slots) slot = slot == 2 ? -1 : slot;
  EXPECT_EQ(wrong_components(slots, wrong, truth, kWidth, kHeight, 0.125).size(), 1U);
  wrong.assign(slots.size(), 0);
  EXPECT_TRUE(wrong_components(slots, wrong, truth, kWidth, kHeight, 0).empty());
}

TEST(TruthClicks, BaseColorsAreComparedWithThePaint) {
  auto colors = three_colors();
  Image paint(4, 1, 3);
  for (int x = 0; x < 4; ++x) {
    paint.at(x, 0, 0) = 0.4F;
    paint.at(x, 0, 1) = paint.at(x, 0, 2) = 0.05F;  // red of half the brightness
  }
  const std::vector<int> slots{0, 0, 0, 1};
  // Only the layers' colors: red is exact, green has too few pixels.
  auto errors = base_color_errors(paint, slots, colors, false, 2);
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_NEAR(errors[0], 0, 1e-6);
  EXPECT_TRUE(std::isnan(errors[1]));
  // Gray (1, 1, 1) is (1.4, .7, .7) from red's (2.4, .3, .3); what was before counts alone.
  colors[0].initial = {0.3F, 0.3F, 0.3F};
  EXPECT_NEAR(base_color_errors(paint, slots, colors, true, 2)[0],
              std::sqrt(1.4 * 1.4 + 2 * 0.7 * 0.7), 1e-5);
  EXPECT_NEAR(base_color_errors(paint, slots, colors, false, 2)[0], 0, 1e-6);
}

}  // namespace
}  // namespace inverse::bench
