// SPDX-License-Identifier: LGPL-2.1-or-later
// olatrelight with its network.
#include <cmath>

#include "relight_fixture.hpp"
#include "tests/srgb.hpp"

namespace inverse::testing {

TEST_F(RelightTest, TheNetworkEvaluatesLightsThatMatter) {
  VideoHarness harness("olatrelight model=network tuning=max-error=0.05 models=" + models(),
                       caps());
  GstElement* relight = harness.find("olatrelight");
  auto frame = sphere.side_by_side();
  auto out = harness.process(frame);
  ASSERT_EQ(out.size(), size_t{kSide} * kSide * 4);
  const auto lit = stat<guint64>(relight, "lit");
  EXPECT_EQ(stat<guint64>(relight, "evaluated"), lit);
  for (int i = 0; i < 4; ++i) {
    frame[0] ^= 1;  // another picture
    out = harness.process(frame);
  }
  EXPECT_LT(stat<guint64>(relight, "evaluated"), lit / 3);
  const double expected_error = stat<double>(relight, "expected-error");
  EXPECT_LE(expected_error, .05);
  g_object_set(relight, "environment-rotation", 30.0F, nullptr);
  out = harness.process(frame);
  EXPECT_FALSE(stat<bool>(relight, "fitted"));
  g_object_set(relight, "adaptive", FALSE, nullptr);
  const auto all = harness.process(frame);
  EXPECT_EQ(stat<guint64>(relight, "evaluated"), lit);
  double off = 0, light = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    off += std::pow(srgb_light(all[i] / 255.0) - srgb_light(out[i] / 255.0), 2);
    light += std::pow(srgb_light(all[i] / 255.0), 2);
  }
  EXPECT_LT(std::sqrt(off / light), expected_error);
  std::vector<std::vector<uint8_t>> pictures;
  for (const char* show : {"olat", "mosaic", "normal", "full-on"}) {
    gst_util_set_object_arg(G_OBJECT(relight), "show", show);
    const auto picture = harness.process(frame);
    EXPECT_FALSE(picture.empty()) << show;
    for (const auto& other : pictures) EXPECT_NE(picture, other) << show;
    pictures.push_back(picture);
  }
  harness.set_src_caps(caps(42, 9));
  EXPECT_EQ(harness.process(random_frame(caps(42, 9), 1)).size(), size_t{21} * 9 * 4);
  EXPECT_TRUE(harness.errors().empty());
}

TEST_F(RelightTest, TheBundledNetworkPreservesTheLight) {
  const char* installed = g_getenv("INVERSE_MODELS");
  if (!installed || !std::filesystem::exists(std::string(installed) + "/olat/features.net"))
    GTEST_SKIP() << "built without libonnx-dev";
  VideoHarness harness("olatrelight model=network environment-location=" + white(), caps(),
                       caps(kSide));
  GstElement* relight = harness.find("olatrelight");
  const auto sum = [](const std::vector<uint8_t>& frame) {
    double total = 0;
    for (size_t i = 0; i < frame.size(); i += 4) total += std::pow(frame[i] / 255., 2.2);
    return total;
  };
  const double relit = sum(harness.process(sphere.side_by_side()));
  gst_util_set_object_arg(G_OBJECT(relight), "show", "full-on");
  const double full = sum(harness.process(sphere.side_by_side()));
  EXPECT_NEAR(relit / full, .986, .02) << "a sphere is no head, but light is light";
  g_object_set(relight, "show", 1, "light-direction", "1,0,0.3", nullptr);
  const auto out = harness.process(sphere.side_by_side());
  EXPECT_GT(at(out, 50, 32)[0], at(out, 14, 32)[0] + 60);
}

TEST_F(RelightTest, WithoutItsNetworkTheElementDoesNotStart) {
  expect_contains(error_of("model=network models=" + folder.path()),
                  "there is no folder " + (folder / "olat"));
  const std::string good = models();
  std::filesystem::resize_file(good + "/olat/light.net", 300);
  expect_contains(error_of("model=network models=" + good), "light.net");
}

TEST_F(RelightTest, TheModelIsThatOfTheStart) {
  VideoHarness harness("olatrelight", caps());
  const auto expected = VideoHarness("olatrelight", caps()).process(sphere.side_by_side());
  gst_util_set_object_arg(G_OBJECT(harness.find("olatrelight")), "model", "network");
  EXPECT_EQ(harness.process(sphere.side_by_side()), expected) << "set before the first frame";
  harness.set_src_caps(caps(42, 9));
  EXPECT_FALSE(harness.process(random_frame(caps(42, 9), 1)).empty());
  EXPECT_TRUE(harness.errors().empty());
}

}  // namespace inverse::testing
