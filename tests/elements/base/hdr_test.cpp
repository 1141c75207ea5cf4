// SPDX-License-Identifier: LGPL-2.1-or-later
// PQ, HLG and BT.2020: light above reference white stays, colors keep their meaning.
#include <algorithm>
#include <cmath>

#include "kernels/image/format/transfer.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/srgb.hpp"

namespace inverse::testing {
namespace {

constexpr int kWidth = 64, kHeight = 48;
constexpr const char* kMetadata =
    "mastering-display-info=(string)34000:16000:13250:34500:7500:3000:15635:16450:10000000:50, "
    "content-light-level=(string)1000:400";

std::string wide_caps(const std::string& format, const std::string& colorimetry,
                      const std::string& more = "") {
  return VideoHarness::caps(
      format, kWidth, kHeight,
      "colorimetry=(string)" + colorimetry + (more.empty() ? "" : ", " + more));
}

void put16(std::vector<uint8_t>& bytes, size_t sample, int value) {
  bytes[2 * sample] = static_cast<uint8_t>(value & 255);
  bytes[2 * sample + 1] = static_cast<uint8_t>(value >> 8);
}
int get16(const std::vector<uint8_t>& bytes, size_t sample) {
  return bytes[2 * sample] | bytes[2 * sample + 1] << 8;
}

/// P010: luma rises from left to right to the peak, in one color.
std::vector<uint8_t> ramp() {
  std::vector<uint8_t> frame(kWidth * kHeight * 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      put16(frame, static_cast<size_t>(y * kWidth + x), (300 + 640 * x / (kWidth - 1)) << 6);
  for (int y = 0; y < kHeight / 2; ++y)
    for (int x = 0; x < kWidth / 2; ++x) {
      const auto at = static_cast<size_t>(kWidth * kHeight + y * kWidth + 2 * x);
      put16(frame, at, 500 << 6);
      put16(frame, at + 1, 520 << 6);
    }
  return frame;
}

/// The largest difference of ten-bit codes.
int code_difference(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
  int worst = a.size() == b.size() ? 0 : 1024;
  for (size_t i = 0; worst < 1024 && i < a.size() / 2; ++i)
    worst = std::max(worst, std::abs((get16(a, i) >> 6) - (get16(b, i) >> 6)));
  return worst;
}

/// RGBA64_LE of one color, 0…1.
std::vector<uint8_t> flat(const std::array<double, 3>& encoded) {
  std::vector<uint8_t> frame(static_cast<size_t>(kWidth * kHeight) * 8, 255);
  for (size_t i = 0; i < frame.size() / 8; ++i)
    for (size_t c = 0; c < 3; ++c)
      put16(frame, 4 * i + c, static_cast<int>(std::lround(encoded[c] * 65535)));
  return frame;
}

std::array<double, 3> pq(const std::array<double, 3>& linear) {
  const Transfer curve = Transfer::of(TransferFunction::pq);
  return {curve.encode(linear[0]), curve.encode(linear[1]), curve.encode(linear[2])};
}

/// The middle of an RGBA64_LE frame.
std::array<double, 3> middle(const std::vector<uint8_t>& frame) {
  if (frame.size() != static_cast<size_t>(kWidth * kHeight) * 8) return {-1, -1, -1};
  const size_t at = 4 * static_cast<size_t>(kHeight / 2 * kWidth + kWidth / 2);
  return {get16(frame, at) / 65535.0, get16(frame, at + 1) / 65535.0,
          get16(frame, at + 2) / 65535.0};
}

constexpr const char* kPqRgb = "1:1:14:7";

}  // namespace

TEST(Hdr, ChainsReturnTheInputWithItsHighlightsAndItsLabels) {
  const auto frame = ramp();
  for (const char* color : {"bt2100-pq", "bt2100-hlg", "bt2020-10", "bt2020"}) {
    const std::string caps = wide_caps("P010_10LE", color, kMetadata);
    const bool hdr = std::string(color).starts_with("bt2100");
    for (const char* line :
         {"intrinsicdecomp ! intrinsiccompose", "globalintrinsic ! intrinsiccompose",
          "intrinsicdecompthesis ! intrinsiccompose", "intrinsicdecomp show=input"}) {
      VideoHarness harness(line, caps, "video/x-raw, format=P010_10LE");
      const auto out = harness.process(frame, 2);
      EXPECT_LE(code_difference(out, frame), 1) << line << ", " << color;
      const std::string label = caps_out_of(harness.harness());
      EXPECT_NE((label + ",").find(std::string("colorimetry=(string)") + color + ","),
                std::string::npos)
          << line << ": " << label;
      for (const char* field : {"mastering-display-info", "content-light-level"})
        EXPECT_EQ(label.find(field) != std::string::npos, hdr) << line << ": " << label;
      EXPECT_TRUE(harness.errors().empty()) << line;
    }
  }
}

// Without the residual, all that is seen went through the solve.
TEST(Hdr, ReflectanceTimesShadingHasTheHighlights) {
  const auto frame = ramp();
  for (const auto& [color, curve] :
       {std::pair{"bt2100-pq", TransferFunction::pq}, {"bt2100-hlg", TransferFunction::hlg}}) {
    const std::string caps = wide_caps("P010_10LE", color);
    VideoHarness harness("intrinsicdecomp ! intrinsiccompose residual=none", caps, caps);
    const auto out = harness.process(frame, 3);
    ASSERT_EQ(out.size(), frame.size());
    const auto light = [&, curve = curve](const std::vector<uint8_t>& bytes, int x) {
      const double code = get16(bytes, static_cast<size_t>(kHeight / 4 * kWidth + x)) >> 6;
      return Transfer::of(curve).decode((code - 64) / 876);
    };
    double peak = 0;
    for (int x = 0; x < kWidth; ++x) {
      EXPECT_NEAR(light(out, x) / light(frame, x), 1, 0.1) << color << " at " << x;
      peak = std::max(peak, light(out, x));
    }
    EXPECT_GT(peak, curve == TransferFunction::pq ? 49 : 3.7) << color;
  }
}

TEST(Hdr, ReferenceWhiteIsWhiteOfOtherCurves) {
  const struct {
    const char* color;
    int code;       // of ten bits
    double linear;  // ITU-R BT.2408: 203 cd/m² or 75 % HLG are 1; 26 cd/m², 38 %, are 0.128
  } cases[] = {{"bt2100-pq", 572, 1},
               {"bt2100-hlg", 721, 1},
               {"bt2100-pq", 397, 26.0 / 203},
               {"bt2100-pq", 940, 1}};
  for (const auto& [color, code, linear] : cases) {
    std::vector<uint8_t> frame(kWidth * kHeight * 3);
    for (size_t i = 0; i < kWidth * kHeight; ++i) put16(frame, i, code << 6);
    for (size_t i = kWidth * kHeight; i < frame.size() / 2; ++i) put16(frame, i, 512 << 6);
    VideoHarness harness("intrinsicdecomp show=input", wide_caps("P010_10LE", color),
                         wide_caps("RGBA64_LE", "sRGB"));
    const auto seen = middle(harness.process(frame));
    for (const double channel : seen)
      EXPECT_NEAR(channel, srgb_code(linear), 0.004) << color << " " << code;
  }
}

// BT.709's red, in BT.2020 (ITU-R BT.2087).
TEST(Hdr, ColorsAreConvertedIfTheOutputHasOtherPrimaries) {
  const auto red = flat(pq({0.6274, 0.0691, 0.0164}));
  VideoHarness narrow("intrinsicdecomp show=input", wide_caps("RGBA64_LE", kPqRgb),
                      wide_caps("RGBA64_LE", "sRGB"));
  const auto seen = middle(narrow.process(red));
  EXPECT_NEAR(seen[0], 1, 0.002);
  EXPECT_NEAR(seen[1], 0, 0.01);
  EXPECT_NEAR(seen[2], 0, 0.01);
  // The layers carry the primaries along.
  VideoHarness composed("intrinsicdecomp ! intrinsiccompose", wide_caps("RGBA64_LE", kPqRgb),
                        wide_caps("RGBA64_LE", "sRGB"));
  const auto edited = middle(composed.process(red));
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(edited[c], seen[c], 0.002) << c;
  // And to BT.2020.
  VideoHarness wide("intrinsicdecomp show=input", wide_caps("RGBA64_LE", "sRGB"),
                    wide_caps("RGBA64_LE", kPqRgb));
  const auto widened = middle(wide.process(flat({1, 0, 0})));
  const auto expected = pq({0.6274, 0.0691, 0.0164});
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(widened[c], expected[c], 0.001) << c;
}

TEST(Hdr, ColorsOutsideTheOutputsGamutAreClipped) {
  VideoHarness harness("intrinsicdecomp show=input", wide_caps("RGBA64_LE", kPqRgb),
                       wide_caps("RGBA64_LE", "sRGB"));
  const auto green = middle(harness.process(flat(pq({0, 0.8, 0}))));
  EXPECT_EQ(green[0], 0);
  EXPECT_NEAR(green[1], srgb_code(0.8 * 1.1329), 0.003);
  EXPECT_EQ(green[2], 0);
}

TEST(Hdr, AnyCodesGiveReflectance) {
  for (const char* color : {"bt2100-pq", "bt2100-hlg"})
    for (const char* element : {"intrinsicdecomp", "globalintrinsic", "intrinsicdecompthesis"}) {
      const std::string caps = wide_caps("P010_10LE", color);
      VideoHarness harness(std::string(element) + " show=reflectance", caps, caps);
      std::vector<uint8_t> darkest(kWidth * kHeight * 3, 0), lightest(kWidth * kHeight * 3, 255);
      for (const auto& frame : {random_frame(caps, 1), darkest, lightest, ramp()})
        EXPECT_EQ(harness.process(frame).size(), frame.size()) << element << ", " << color;
      // What was there before does not show in what comes after.
      const auto out = harness.process(ramp(), 3);
      int least = 1023, most = 0;
      for (size_t i = 0; i < kWidth * kHeight; ++i) {
        least = std::min(least, get16(out, i) >> 6);
        most = std::max(most, get16(out, i) >> 6);
      }
      EXPECT_GT(least, 100) << element << ", " << color;
      EXPECT_TRUE(harness.errors().empty()) << element;
    }
}

TEST(Hdr, OutputOfOrdinaryRangeHasNoMasteringMetadata) {
  VideoHarness harness("intrinsicdecomp show=input", wide_caps("P010_10LE", "bt2100-pq", kMetadata),
                       wide_caps("RGBA", "sRGB"));
  ASSERT_FALSE(harness.process(ramp()).empty());
  const std::string label = caps_out_of(harness.harness());
  EXPECT_EQ(label.find("mastering"), std::string::npos) << label;
  EXPECT_EQ(label.find("light-level"), std::string::npos) << label;
}

TEST(Hdr, LayersOfItBecomeDeepPictures) {
  VideoHarness harness("intrinsicdecomp ! intrinsiccompose", wide_caps("P010_10LE", "bt2100-pq"),
                       "video/x-raw, format={ NV12, I420_10LE, P010_10LE }");
  ASSERT_FALSE(harness.process(ramp()).empty());
  const std::string label = caps_out_of(harness.harness());
  EXPECT_NE(label.find("P010_10LE"), std::string::npos) << label;
  EXPECT_NE(label.find("bt2100-pq"), std::string::npos) << label;
}

// intrinsicsplit writes sRGB in BT.709 unless what follows insists.
TEST(Hdr, SplitLayersAreConvertedOrKept) {
  const std::string in = wide_caps("RGBA64_LE", kPqRgb);
  const auto red = flat(pq({0.6274, 0.0691, 0.0164})), light = flat(pq({4, 4, 4}));
  VideoHarness plain("intrinsicdecomp ! intrinsicsplit name=s s.input ! identity", in,
                     VideoHarness::caps("RGBA64_LE", kWidth, kHeight));
  const auto seen = middle(plain.process(red));
  EXPECT_NEAR(seen[0], 1, 0.002);
  EXPECT_NEAR(seen[1], 0, 0.01);
  VideoHarness kept("intrinsicdecomp ! intrinsicsplit name=s s.input ! identity", in, in);
  EXPECT_NEAR(middle(kept.process(light))[1], pq({4, 4, 4})[1], 0.001);
}

}  // namespace inverse::testing
