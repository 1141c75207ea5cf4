// SPDX-License-Identifier: LGPL-2.1-or-later
// Work that the decomposers skip depending on the scene, by stats.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/elements/draw.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/srgb.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {
namespace {

constexpr int kWidth = 160, kHeight = 120;

/// Soft blotches of color, or grains of paint under a hard shadow; another picture for every
/// `time`.
std::vector<uint8_t> picture(bool soft, int time) {
  return draw(kWidth, kHeight, [&](int x, int y, int c) {
    const double wave = std::sin(0.025 * x + 0.04 * y + 2 * c + 0.015 * time);
    const unsigned paint = static_cast<unsigned>((x / 2) * 7919 + y * 104729 + c * 31) % 97;
    const double light = x + 2 * y > 150 + time ? 0.9 : 0.3;
    return 255 * (soft ? 0.5 + 0.3 * wave : light * (0.1 + 0.009 * paint));
  });
}

struct Skipped {
  std::string text;
  guint halvings = 0;
  double distance = 0;
};

Skipped skipped_of(VideoHarness& harness, const char* factory) {
  GstElement* element = harness.find(factory);
  return {find_stat<std::string>(element, "skipped").value_or(""),
          find_stat<guint>(element, "halvings").value_or(0),
          find_stat<double>(element, "half-distance").value_or(0)};
}

Skipped after(const char* line, const char* factory, bool soft, int frames) {
  const std::string caps = VideoHarness::caps("RGBA", kWidth, kHeight);
  VideoHarness harness(line, caps, caps);
  for (int i = 0; i < frames; ++i) EXPECT_FALSE(harness.process(picture(soft, i)).empty());
  return skipped_of(harness, factory);
}

bool has(const Skipped& skipped, const char* what) {
  return skipped.text.find(what) != std::string::npos;
}

}  // namespace

TEST(ReusePolicy, TermsWithoutWeightAreNamed) {
  EXPECT_FALSE(has(after("intrinsicdecomp", "intrinsicdecomp", true, 3), "chroma bins"));
  EXPECT_TRUE(has(after("intrinsicdecomp tuning=chroma-weight=0", "intrinsicdecomp", true, 3),
                  "chroma bins: their weight is 0"));
  const Skipped thesis = after(
      "intrinsicdecompthesis "
      "tuning=irls-iterations=1:pcg-iterations=1:w-non-local=0:w-clustering=0",
      "intrinsicdecompthesis", true, 2);
  EXPECT_TRUE(has(thesis, "samples: none, or their weight is 0")) << thesis.text;
  EXPECT_TRUE(has(thesis, "clusters: their weight is 0")) << thesis.text;
}

TEST(ReusePolicy, HalfResolutionFollowsItsBound) {
  const Skipped soft = after("intrinsicdecomp", "intrinsicdecomp", true, 32);
  EXPECT_EQ(soft.halvings, 1u);
  EXPECT_EQ(soft.halvings, 1u);
  EXPECT_GT(soft.distance, 0);
  EXPECT_LT(soft.distance, 0.06);
  const Skipped sharp = after("intrinsicdecomp", "intrinsicdecomp", false, 32);
  EXPECT_EQ(sharp.halvings, 0u);
  EXPECT_GT(sharp.distance, 0.06);
  for (const char* line :
       {"intrinsicdecomp tuning=half-tolerance=0", "intrinsicdecomp adaptive=false"}) {
    const Skipped never = after(line, "intrinsicdecomp", true, 32);
    EXPECT_EQ(never.halvings, 0u) << line;
    EXPECT_EQ(never.distance, 0) << line;
  }
  EXPECT_EQ(after("intrinsicdecomp tuning=half-resolution=true:quarter-resolution=true",
                  "intrinsicdecomp", false, 2)
                .halvings,
            2u);
}

TEST(ReusePolicy, BouncedLightOfVideoInBlackAndWhite) {
  const std::string caps = VideoHarness::caps("RGBA", kWidth, kHeight);
  VideoHarness all("globalintrinsic show=mosaic", caps, caps);
  const auto in = [](int time, bool color) {
    std::vector<uint8_t> frame = picture(false, time);
    for (size_t i = 0; i < frame.size() && !color; i += 4) frame[i + 1] = frame[i + 2] = frame[i];
    return frame;
  };
  const auto bounced = [](const std::vector<uint8_t>& mosaic) {  // lower right of four
    int largest = 0;
    for (size_t y = kHeight / 2 + 1; y < kHeight; ++y)
      for (size_t x = kWidth / 2 + 1; x < kWidth; ++x)
        for (size_t c = 0; c < 3; ++c)
          largest = std::max(largest, int(mosaic[4 * (y * kWidth + x) + c]));
    return largest;
  };
  const char* reason = "no color to find it by";
  for (int k = 0; k < 16; ++k) {
    EXPECT_EQ(bounced(all.process(in(k, false))), 0) << k;
    EXPECT_EQ(has(skipped_of(all, "globalintrinsic"), reason), k >= 10) << k;
  }
  int seen = 0;
  for (int k = 0; k < 8; ++k) {
    seen = bounced(all.process(in(k, true)));
    EXPECT_EQ(has(skipped_of(all, "globalintrinsic"), reason), k < 3) << k;
  }
  EXPECT_GT(seen, 0) << "color came back";
  EXPECT_TRUE(all.errors().empty());
}

/// A video in which everything, nothing, and little changes; frame by frame. Its fine colored noise
/// converges slowly, so nothing changes for long.
std::vector<std::vector<uint8_t>> mixed_video() {
  std::vector<std::vector<uint8_t>> frames;
  for (int k = 0; k < 8; ++k) frames.push_back(picture(false, 4 * k));
  for (int k = 0; k < 96; ++k) frames.push_back(frames.back());
  for (int k = 0; k < 24; ++k) {
    auto frame = picture(false, 28);
    for (int y = 40; y < 52; ++y)
      std::fill_n(&frame[4 * static_cast<size_t>(y * kWidth + 20 + 2 * k)], 48, uint8_t{200});
    frames.push_back(frame);
  }
  return frames;
}

/// Rms difference of the logarithm of sRGB codes, as linear light.
double log_difference(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
  const auto light = [](uint8_t code) {
    const double v = code / 255.0;
    return std::log(srgb_light(v) + 0.02);
  };
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::pow(light(a[i]) - light(b[i]), 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

class SkipError : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, SkipError, ::testing::Values("intrinsicdecomp", "globalintrinsic"));

TEST_P(SkipError, ZeroSkipsNothingThatChangesTheResult) {
  const std::string caps = VideoHarness::caps("RGBA", kWidth, kHeight), name = GetParam();
  VideoHarness none(name + " show=shading skip-error=0", caps, caps);
  VideoHarness whole(name + " show=shading adaptive=false", caps, caps);
  for (const auto& frame : mixed_video()) ASSERT_EQ(none.process(frame), whole.process(frame));
}

TEST_P(SkipError, ScalesTolerancesThatAreNotSet) {
  const std::string caps = VideoHarness::caps("RGBA", 32, 24), name = GetParam();
  VideoHarness harness(name + " quality=high skip-error=0.2 tuning=chroma-tolerance=0.03", caps,
                       caps);
  ASSERT_FALSE(harness.process(std::vector<uint8_t>(size_t{4} * 32 * 24, 99)).empty());
  for (const auto& [field, value] : {std::pair{"chroma-tolerance", 0.03F},
                                     {"cycle-tolerance", 0.006F},
                                     {"edge-tolerance", 0.1F},
                                     {"half-tolerance", 0.12F},
                                     {"repeat-tolerance", 0.002F}})
    EXPECT_FLOAT_EQ(float(stat<double>(harness.find(name), field)), value) << field;
}

TEST_P(SkipError, BoundsTheErrorAndMoreSkipsMore) {
  const std::string caps = VideoHarness::caps("RGBA", kWidth, kHeight), name = GetParam();
  VideoHarness whole(name + " show=shading adaptive=false", caps, caps);
  std::vector<std::vector<uint8_t>> wanted;
  for (const auto& frame : mixed_video()) wanted.push_back(whole.process(frame));
  guint64 before = UINT64_MAX;
  for (const char* error : {"0.3", "0.1", "0.02"}) {
    VideoHarness harness(name + " show=shading skip-error=" + error, caps, caps);
    double worst = 0;
    guint64 skipped = 0;  // tiles whose edges were not evaluated
    size_t k = 0;
    for (const auto& frame : mixed_video()) {
      update_max(worst, log_difference(harness.process(frame), wanted[k++]));
      GstElement* element = harness.find(name);
      const bool kept = stat<bool>(element, "reused");
      const guint tiles = stat<guint>(element, "tiles");
      skipped += kept ? tiles : tiles - stat<guint>(element, "tiles-evaluated");
    }
    std::printf("%s skip-error=%s: at most %.4f rms log shading, %" G_GUINT64_FORMAT
                " tiles skipped\n",
                name.c_str(), error, worst, skipped);
    EXPECT_LE(worst, std::atof(error)) << error;
    if (std::atof(error) >= 0.1) {
      EXPECT_GT(skipped, 1000U) << error;
    }
    EXPECT_LE(skipped, before) << error;
    before = skipped;
  }
}

}  // namespace inverse::testing
