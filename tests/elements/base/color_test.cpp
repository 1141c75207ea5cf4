// SPDX-License-Identifier: LGPL-2.1-or-later
// What caps say of color, and what they leave open: the picture that is meant, or one clear error.
#include "tests/elements/element_test.hpp"

namespace inverse::testing {
namespace {

/// Y'CbCr codes of 8 bits, inside the RGB cube in every matrix below.
constexpr int kY = 130, kCb = 100, kCr = 150;

struct Meaning {
  const char* colorimetry;  ///< "range:matrix:transfer:primaries" or a name; empty: not in the caps
  double kr, kb;
  bool full = false;
  int width = 64, height = 48;
};

/// R'G'B' that the codes stand for, 0…255.
std::array<double, 3> expected(const Meaning& meaning) {
  const double y = meaning.full ? kY / 255.0 : (kY - 16) / 219.0;
  const double cb = (kCb - 128) / (meaning.full ? 255.0 : 224.0);
  const double cr = (kCr - 128) / (meaning.full ? 255.0 : 224.0);
  const double r = y + 2 * (1 - meaning.kr) * cr, b = y + 2 * (1 - meaning.kb) * cb;
  const double g = (y - meaning.kr * r - meaning.kb * b) / (1 - meaning.kr - meaning.kb);
  return {255 * r, 255 * g, 255 * b};
}

std::string with_colorimetry(const std::string& format, const char* colorimetry, int width = 64,
                             int height = 48) {
  return VideoHarness::caps(
      format, width, height,
      *colorimetry ? "colorimetry=(string)\"" + std::string(colorimetry) + "\"" : "");
}

}  // namespace

TEST(Color, CompleteAndPartialCapsGiveTheIntendedPicture) {
  const Meaning meanings[] = {
      {"", 0.299, 0.114},                      // absent: by the size of the picture
      {"", 0.2126, 0.0722, false, 1280, 720},  // which is GStreamer's rule
      {"bt601", 0.299, 0.114},
      {"bt709", 0.2126, 0.0722},
      {"smpte240m", 0.212, 0.087},
      {"bt2020", 0.2627, 0.0593},
      {"1:4:0:0", 0.299, 0.114, true},      // full range; transfer, primaries unknown
      {"0:4:7:1", 0.299, 0.114},            // range unknown: Y'CbCr is limited
      {"2:2:5:2", 0.3, 0.11},               // FCC
      {"2:0:0:0", 0.299, 0.114},            // matrix unknown
      {"0:0:0:0", 0.299, 0.114},            // all unknown
      {"1:1:7:1", 0.299, 0.114},            // that of RGB, which this is not
      {"2:5:2:3", 0.212, 0.087},            // the oddest that makes sense
      {"none that we know", 0.299, 0.114},  // not a colorimetry at all
  };
  for (const Meaning& meaning : meanings) {
    const auto [width, height] = std::pair{meaning.width, meaning.height};
    const std::string in = with_colorimetry("I420", meaning.colorimetry, width, height),
                      out = VideoHarness::caps("RGBA", width, height);
    VideoHarness harness("intrinsicdecomp show=input", in, out);
    auto frame = flat_frame(in, kY);
    const auto chroma = frame.begin() + width * height;
    std::fill_n(chroma, width * height / 4, static_cast<uint8_t>(kCb));
    std::fill_n(chroma + width * height / 4, width * height / 4, static_cast<uint8_t>(kCr));
    const auto shown = harness.process(frame);
    ASSERT_EQ(shown.size(), static_cast<size_t>(width) * height * 4) << meaning.colorimetry;
    const auto rgb = expected(meaning);
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(shown[c], rgb[c], 1.01) << in << ", channel " << c;
    EXPECT_TRUE(harness.errors().empty()) << in;
  }
}

TEST(Color, RgbOfLimitedRangeIsStretched) {
  const std::string in = with_colorimetry("RGBA", "2:1:7:1"),
                    out = with_colorimetry("RGBA", "sRGB");
  VideoHarness harness("intrinsicdecomp show=input", in, out);
  const auto shown = harness.process(flat_frame(in, 126));
  ASSERT_FALSE(shown.empty());
  EXPECT_NEAR(shown[0], (126 - 16) * 255.0 / 219, 1);
}

// Every element that draws meets this, too.
TEST(Color, LogarithmicCurvesAreOneClearErrorWhereverTheyAppear) {
  const std::pair<const char*, const char*> curves[] = {{"2:6:9:7", "100:1"}, {"2:6:10:7", "316"}};
  const std::string plain = VideoHarness::caps("RGBA", 64, 48);
  for (const auto& [colorimetry, name] : curves) {
    const std::string caps = with_colorimetry("P010_10LE", colorimetry);
    const struct {
      const char *line, *factory;
      const std::string &in, &out;
    } places[] = {
        {"intrinsicdecomp", "intrinsicdecomp", caps, plain},
        {"intrinsicdecompthesis", "intrinsicdecompthesis", caps, plain},
        {"intrinsicdecomp", "intrinsicdecomp", plain, caps},
        {"intrinsicdecomp ! intrinsiccompose", "intrinsiccompose", plain, caps},
        {"intrinsicdecomp ! intrinsicsplit name=s s.reflectance ! identity", "intrinsicsplit",
         plain, caps},
    };
    for (const auto& place : places) {
      VideoHarness harness(place.line, place.in, place.out);
      for (int i = 0; i < 2; ++i)  // further buffers are not reported again
        EXPECT_NE(harness.push(random_frame(place.in, 1)), GST_FLOW_OK) << place.line;
      const auto errors = harness.errors();
      expect_one(errors, name);
      EXPECT_TRUE(errors.at(0).starts_with(place.factory)) << place.line << ", " << colorimetry;
    }
  }
}

}  // namespace inverse::testing
