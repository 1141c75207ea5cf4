// SPDX-License-Identifier: LGPL-2.1-or-later
// What every decomposer guarantees: formats, sizes, bad input, events, properties.
#include <gst/controller/gstdirectcontrolbinding.h>
#include <gst/controller/gstinterpolationcontrolsource.h>

#include <cmath>

#include "tests/elements/draw.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/elements/layer_of.hpp"
#include "tests/srgb.hpp"

namespace inverse::testing {
namespace {

constexpr const char* kDecomposers[] = {"intrinsicdecomp", "intrinsicdecompthesis",
                                        "globalintrinsic", "globalintrinsicthesis"};
constexpr const char* kAnyLayers =
    "video/x-raw(" GST_CAPS_FEATURE_META_INVERSE_LAYERS "), layers=(string){ intrinsic, global }";

/// A code value of 8-bit sRGB in linear light.
float linear_of(uint8_t code) { return srgb_light(static_cast<float>(code) / 255.0f); }

/// A decomposer that does as little as it can, for what does not depend on how well it does.
std::string quick(const std::string& name) {
  if (name == "globalintrinsicthesis")
    return name + " tuning=steps=1:pcg-iterations=1:refine-rounds=0";
  if (name == "intrinsicdecompthesis") return name + " tuning=irls-iterations=1:pcg-iterations=1";
  return name;
}

class Decomposer : public ::testing::TestWithParam<const char*> {};

}  // namespace

// Those with kernels of their own; format_test.cpp has the others.
TEST_P(Decomposer, FormatsPassThroughUnchangedWhenTheInputIsShown) {
  for (const std::string format :
       {"RGBA", "BGRA", "RGBx", "BGRx", "RGB", "BGR", "RGBA64_LE", "GRAY8", "GRAY16_LE", "NV12",
        "I420", "YUY2", "UYVY", "P010_10LE", "I420_10LE"}) {
    for (const auto& [width, height] : {std::pair{15, 10}, {349, 287}, {1, 1}, {2, 3}}) {
      const std::string caps = VideoHarness::caps(format, width, height);
      VideoHarness harness(quick(GetParam()) + " show=input", caps, caps);
      // Random chroma leaves the RGB cube and does not come back from it: a flat frame for Y'CbCr.
      const bool rgb = format.find('R') != std::string::npos || format.find("BGR") == 0;
      auto frame = rgb ? random_frame(caps, 1) : flat_frame(caps, 128);
      if (format == "I420_10LE")
        for (size_t i = 0; i < frame.size(); ++i)
          frame[i] = i % 2 ? 2 : 0;  // 512: ten bits in the low end
      const auto before = visible(caps, frame), after = visible(caps, harness.process(frame));
      ASSERT_EQ(before.size(), after.size()) << format;
      const bool padded = format.find('x') != std::string::npos;  // every fourth byte means nothing
      const bool deep = format.find("LE") != std::string::npos;
      for (size_t i = 0; i < before.size(); i += deep ? 2 : 1) {
        if (padded && i % 4 == 3) continue;
        const int was = deep ? before[i] + 256 * before[i + 1] : before[i];
        const int is = deep ? after[i] + 256 * after[i + 1] : after[i];
        // One code value of 8 bits; 10 bits in the high end of 16 step by 64.
        ASSERT_NEAR(is, was, deep ? 64 : 1)
            << format << " " << width << "x" << height << " at " << i;
      }
    }
  }
}

// Long and thin, both ways, through decomposer, editor and the elements that draw.
TEST_P(Decomposer, VeryWideAndVeryTallFramesFlow) {
  const std::string name = quick(GetParam());
  for (const auto& [width, height] : {std::pair{8192, 16}, {16, 8192}}) {
    const std::string caps = VideoHarness::caps("RGBA", width, height);
    const auto frame = random_frame(caps, 2);
    for (const std::string& line :
         {name, name + " ! intrinsicrecolor strength=0 ! intrinsiccompose",
          name + " ! intrinsicsplit name=s s.input ! identity"}) {
      VideoHarness harness(line, caps, caps);
      for (int i = 0; i < 2; ++i) {
        const auto shown = harness.process(frame);
        ASSERT_EQ(shown.size(), frame.size()) << line << " " << width << "x" << height;
        if (line == name) {
          const auto [darkest, brightest] = std::minmax_element(shown.begin(), shown.end());
          EXPECT_GT(*brightest - *darkest, 50) << "reflectance of noise is not flat";
        } else {
          EXPECT_LE(largest_difference(shown, frame), 1) << line << " " << width << "x" << height;
        }
      }
      EXPECT_TRUE(harness.errors().empty());
    }
  }
}

TEST_P(Decomposer, ConvertsBetweenFormats) {
  const std::string in = VideoHarness::caps("NV12", 64, 48),
                    out = VideoHarness::caps("BGR", 64, 48);
  VideoHarness harness(std::string(GetParam()) + " show=input", in, out);
  auto frame = flat_frame(in, 128);
  const auto shown = harness.process(frame);
  ASSERT_EQ(shown.size(), 64u * 48 * 3);
  for (uint8_t value : shown) ASSERT_NEAR(value, 130, 1);  // (128 - 16) · 255 / 219, chroma neutral
}

TEST_P(Decomposer, DifficultPicturesGiveFiniteLayers) {
  const int width = 32, height = 24;
  const std::string caps = VideoHarness::caps("RGBA", width, height);
  const auto picture = [&](auto value) { return draw(width, height, value); };
  std::mt19937 random(3);
  const std::vector<std::pair<const char*, std::vector<uint8_t>>> pictures = {
      {"black", picture([](int, int, int) { return 0; })},
      {"white", picture([](int, int, int) { return 255; })},
      {"one color", picture([](int, int, int c) { return c == 0 ? 255 : 0; })},
      {"hot pixel", picture([](int x, int y, int) { return x == 7 && y == 9 ? 255 : 1; })},
      {"checkerboard", picture([](int x, int y, int) { return (x + y) % 2 ? 255 : 0; })},
      {"noise of one code value",
       picture([&](int, int, int) { return 100 + static_cast<int>(random() % 2); })},
  };
  VideoHarness harness(GetParam(), caps, kAnyLayers);
  for (int round = 0; round < 2; ++round) {
    for (const auto& [name, frame] : pictures) {
      const Buffer buffer = harness.process_buffer(frame);
      const auto layer = layer_of(buffer.get(), GST_INVERSE_ROLE_INTRINSIC),
                 color = layer_of(buffer.get(), GST_INVERSE_ROLE_LIGHT);
      ASSERT_EQ(layer.size(), frame.size()) << name;
      const std::string method = GetParam();
      const bool exact = method == "intrinsicdecomp" || method == "globalintrinsic";
      const float floor = method == "intrinsicdecompthesis" ? 1e-3F : 0;
      double model = 0, light = 0;  // sums over the frame, light with chapter 3's floor
      for (size_t i = 0; i < layer.size(); ++i) {
        ASSERT_TRUE(std::isfinite(layer[i])) << name << " at " << i;
        ASSERT_GE(layer[i], 0.0f) << name << " at " << i;
        if (i % 4 == 3) continue;
        const float product = layer[i] * layer[i | 3] * (color.empty() ? 1 : color[i]);
        const float linear = linear_of(frame[i]);
        if (exact) {
          ASSERT_NEAR(product, linear, 1e-5 + 1e-4 * linear) << name << " at " << i;
        }
        model += product;
        light += std::max(linear, floor);
      }
      if (exact) continue;
      // The thesis' models are soft constraints, loosest where channels are black: of pure red
      // chapter 3's explained .147 and .154; chapter 5's, with green and blue, 1.263.
      const bool red = name == std::string("one color");
      const double share = !red ? 1 : floor > 0 ? 0.15 : 1.263;
      EXPECT_NEAR(model, share * light, (red ? 0.008 : 0.001) * light + 1e-6) << name;
    }
  }
}

TEST_P(Decomposer, AlternatingBlackAndWhiteFramesComeOutOneForOne) {
  const std::string caps = VideoHarness::caps("I420", 48, 32);
  VideoHarness harness(GetParam(), caps, caps);
  for (int i = 0; i < 12; ++i) {
    auto frame = flat_frame(caps, 128);
    std::fill_n(frame.begin(), 48 * 32, static_cast<uint8_t>(i % 2 ? 235 : 16));
    const auto shown = harness.process(frame);
    ASSERT_FALSE(shown.empty());
    if (i % 2) {
      EXPECT_GT(shown[0], 150) << "frame " << i;
    }
  }
  EXPECT_TRUE(harness.errors().empty());
}

TEST_P(Decomposer, AShortBufferIsOneClearError) {
  const std::string caps = VideoHarness::caps("RGBA", 64, 48);
  VideoHarness harness(GetParam(), caps, caps);
  EXPECT_EQ(harness.push(std::vector<uint8_t>(1000)), GST_FLOW_ERROR);
  expect_one(harness.errors(), "1000 bytes");
}

TEST_P(Decomposer, InterlacedVideoIsRefusedWithAdvice) {
  const auto result = run_line(
      "videotestsrc num-buffers=2 ! video/x-raw,width=64,height=48,interlace-mode=interleaved ! " +
      std::string(GetParam()) + " ! fakesink");
  expect_contains(result.first_error(), "insert deinterlace");
}

TEST_P(Decomposer, UnsupportedTransferCurvesAreRefusedByName) {
  const auto result = run_line(
      "videotestsrc num-buffers=2 ! "
      "video/x-raw,format=P010_10LE,width=64,height=48,colorimetry=2:6:9:7 ! " +
      std::string(GetParam()) + " ! fakesink");
  expect_contains(result.first_error(), GetParam());
  expect_contains(result.first_error(), "logarithmic");
}

TEST_P(Decomposer, AFrameTooLargeForTheDeviceNamesTheLimit) {
  VideoHarness harness(GetParam(), VideoHarness::caps("GRAY8", 32000, 32000));
  const auto errors = harness.errors();
  ASSERT_FALSE(errors.empty());
  expect_contains(errors[0], "; use a smaller frame or another device");
  expect_contains(errors[0],
                  std::string("the largest frame of this shape that ") + GetParam() + " takes");
}

TEST_P(Decomposer, CapsChangesFlushesAndSeeksAreSurvived) {
  const std::string name = GetParam();
  VideoHarness harness(name, VideoHarness::caps("RGBA", 32, 24));
  for (int i = 0; i < 10; ++i) {
    const std::string caps = VideoHarness::caps(i % 2 ? "NV12" : "RGBA", 16 + 6 * i, 40 - 2 * i);
    harness.set_src_caps(caps);
    EXPECT_FALSE(harness.process(random_frame(caps, i)).empty()) << caps;
    if (i % 3 == 0) harness.flush();
  }
  EXPECT_TRUE(harness.errors().empty());
}

/// A source of variable rate says so with every change of it; frames go on as they were.
TEST_P(Decomposer, AnotherRateChangesNothing) {
  const std::string caps = "video/x-raw,format=RGBA,width=40,height=30,framerate=";
  std::vector<std::vector<uint8_t>> first;
  for (const bool changes : {false, true}) {
    VideoHarness harness(GetParam(), caps + "25/1", "video/x-raw,format=RGBA");
    for (int i = 0; i < 6; ++i) {
      if (changes && i == 3) harness.set_src_caps(caps + "12/1");
      if (changes && i == 5) harness.set_src_caps(caps + "0/1,pixel-aspect-ratio=12/11");
      const auto shown = harness.process(random_frame(caps + "25/1", i / 2));
      if (changes)
        EXPECT_EQ(shown, first[i]) << "frame " << i;
      else
        first.push_back(shown);
    }
    EXPECT_EQ(stat<guint64>(harness.find(GetParam()), "frames"), 6u);
    EXPECT_TRUE(harness.errors().empty());
  }
}

TEST_P(Decomposer, SameFramesAndSeedGiveTheSameBytes) {
  const std::string caps = VideoHarness::caps("RGBA", 40, 30);
  std::vector<std::vector<uint8_t>> first;
  for (int run = 0; run < 2; ++run) {
    VideoHarness harness(GetParam(), caps, caps);
    for (int i = 0; i < 4; ++i) {
      const auto shown = harness.process(random_frame(caps, i));
      if (run == 0)
        first.push_back(shown);
      else
        EXPECT_EQ(shown, first[i]) << "frame " << i;
    }
  }
}

TEST_P(Decomposer, StatsReportTheTimeOfAFrame) {
  const std::string caps = VideoHarness::caps("RGBA", 40, 30);
  VideoHarness harness(GetParam(), caps, caps);
  for (int i = 0; i < 3; ++i) harness.process(random_frame(caps, i));
  GstElement* element = harness.find(GetParam());
  EXPECT_EQ(stat<guint64>(element, "frames"), 3u);
  EXPECT_GT(stat<double>(element, "wall-ms"), 0);
  EXPECT_GT(stat<guint64>(element, "device-bytes"), 40u * 30 * 16);
}

TEST_P(Decomposer, AddsOneFrameOfLatencyToLivePipelines) {
  const std::string caps = VideoHarness::caps("RGBA", 40, 30);
  VideoHarness harness(GetParam(), caps, caps);
  gst_harness_set_upstream_latency(harness.harness(), 5 * GST_MSECOND);
  harness.process(random_frame(caps, 1));
  EXPECT_EQ(gst_harness_query_latency(harness.harness()), 45 * GST_MSECOND);
}

TEST_P(Decomposer, ShowCanBeDrivenWhilePlaying) {
  const std::string caps = VideoHarness::caps("RGBA", 40, 30);
  VideoHarness harness(std::string(GetParam()) + " show=shading", caps, caps);
  const auto frame = random_frame(caps, 9);
  EXPECT_GT(largest_difference(harness.process(frame), frame), 1);
  g_object_set(harness.find(GetParam()), "show", 2 /* input */, nullptr);
  EXPECT_LE(largest_difference(harness.process(frame), frame), 1);
}

INSTANTIATE_TEST_SUITE_P(All, Decomposer, ::testing::ValuesIn(kDecomposers),
                         [](const auto& info) { return std::string(info.param); });

TEST(Layers, ReflectanceTimesShadingIsTheInput) {
  const std::string caps = VideoHarness::caps("RGBA", 33, 21);
  VideoHarness harness("intrinsicdecomp light-color-slope=0", caps, kAnyLayers);
  const auto frame = random_frame(caps, 5);
  const auto layer = layer_of(harness.process_buffer(frame).get(), GST_INVERSE_ROLE_INTRINSIC);
  ASSERT_EQ(layer.size(), frame.size());
  for (size_t i = 0; i < frame.size(); ++i) {
    if (i % 4 == 3) continue;
    ASSERT_NEAR(layer[i] * layer[i | 3], linear_of(frame[i]), 2e-3) << i;
  }
}

TEST(Layers, CanBeReadReplacedAndCopiedThroughTheInstalledHeader) {
  const std::string caps = VideoHarness::caps("RGBA", 8, 6);
  VideoHarness harness("intrinsicdecomp", caps, kAnyLayers);
  const Buffer buffer = harness.process_buffer(random_frame(caps, 5));
  EXPECT_FALSE(has_pixels(buffer.get()));
  const Buffer copy(gst_buffer_copy(buffer.get()));
  GstInverseLayersMeta* meta = gst_buffer_get_inverse_layers_meta(copy.get());
  ASSERT_NE(meta, nullptr);
  EXPECT_EQ(meta->width, 8u);
  EXPECT_EQ(meta->height, 6u);
  std::vector<float> mine(8 * 6 * 4, 0.25f);
  EXPECT_TRUE(replace_layer(copy.get(), GST_INVERSE_ROLE_INTRINSIC, mine));
  GBytes* bytes = g_bytes_new(mine.data(), 7);
  EXPECT_FALSE(meta->upload(meta, GST_INVERSE_ROLE_INTRINSIC, bytes));
  g_bytes_unref(bytes);
  EXPECT_EQ(meta->download(meta, GST_INVERSE_ROLE_MASK), nullptr);
  EXPECT_EQ(layer_of(copy.get(), GST_INVERSE_ROLE_INTRINSIC), mine);
  EXPECT_NE(layer_of(buffer.get(), GST_INVERSE_ROLE_INTRINSIC), mine)
      << "the original must not change with its copy";
}

TEST(Pipelines, TwoDecomposersInOneProcessDoNotDisturbEachOther) {
  const std::string source =
      "videotestsrc num-buffers=12 pattern=ball ! video/x-raw,width=64,height=48 ! ";
  const auto alone = run_line(source + "intrinsicdecomp show=shading ! appsink name=out");
  const auto both = run_line(source +
                             "tee name=t t. ! queue ! intrinsicdecompthesis ! fakesink "
                             "t. ! queue ! intrinsicdecomp show=shading ! appsink name=out");
  EXPECT_TRUE(both.eos);
  EXPECT_EQ(both.frames, alone.frames);
}

TEST(Properties, ControllersReachLiveProperties) {
  const std::string caps = VideoHarness::caps("RGBA", 16, 12);
  VideoHarness harness("intrinsicdecomp", caps, caps);
  GstElement* element = harness.find("intrinsicdecomp");
  GstControlSource* source = gst_interpolation_control_source_new();
  g_object_set(source, "mode", GST_INTERPOLATION_MODE_LINEAR, nullptr);
  gst_timed_value_control_source_set(GST_TIMED_VALUE_CONTROL_SOURCE(source), 0, 0.0);
  gst_timed_value_control_source_set(GST_TIMED_VALUE_CONTROL_SOURCE(source), GST_SECOND, 25.0);
  gst_object_add_control_binding(
      GST_OBJECT(element),
      gst_direct_control_binding_new_absolute(GST_OBJECT(element), "temporal-weight", source));
  for (int i = 0; i < 6; ++i) harness.process(random_frame(caps, i));
  EXPECT_NEAR(property<gfloat>(element, "temporal-weight"), 5.0f, 1e-3f);  // at 5/25 s
  gst_object_unref(source);
}

TEST(Properties, QualityIsAPresetThatExplicitValuesOverrule) {
  const std::string caps = VideoHarness::caps("RGBA", 16, 12);
  VideoHarness harness("intrinsicdecompthesis adaptive=false tuning=irls-iterations=5 quality=best",
                       caps, caps);
  harness.process(random_frame(caps, 1));
  GstElement* element = harness.find("intrinsicdecompthesis");
  EXPECT_EQ(stat<int>(element, "irls-iterations"), 5);
  EXPECT_EQ(stat<int>(element, "pcg-iterations"), 16);
}

TEST(Properties, TuningTakesAllEntriesOrNone) {
  const std::string caps = VideoHarness::caps("RGBA", 16, 12);
  VideoHarness harness("intrinsicdecompthesis adaptive=false tuning=irls-iterations=2", caps, caps);
  GstElement* element = harness.find("intrinsicdecompthesis");
  const auto irls = [&] {
    harness.process(random_frame(caps, 1));
    return stat<int>(element, "irls-iterations");
  };
  const auto tuning = [&] { return property<std::string>(element, "tuning"); };
  EXPECT_EQ(irls(), 2);
  g_object_set(element, "tuning", "irls-iterations = 3, irls=printed", nullptr);
  EXPECT_EQ(irls(), 3) << "live";
  EXPECT_EQ(tuning(), "irls-iterations = 3, irls=printed");
  EXPECT_TRUE(harness.warnings().empty());
  for (const char* wrong :
       {"irls-iterations=1:magic=1", "irls-iterations=1:irls=maybe", "irls-iterations=0",
        "irls-iterations=many", "irls-iterations", "w-data=nan", "seed=1"}) {
    g_object_set(element, "tuning", wrong, nullptr);
    expect_one(harness.warnings(), wrong, "keyframe-spacing");
    EXPECT_EQ(irls(), 3) << wrong;
    EXPECT_EQ(tuning(), "irls-iterations = 3, irls=printed");
  }
  g_object_set(element, "tuning", "", nullptr);
  EXPECT_EQ(irls(), 4) << "what it does not name returns to its default";
}

TEST(Properties, ElementsDoNotStartWithATuningThatCannotBeRead) {
  const LineResult line =
      run_line("videotestsrc num-buffers=1 ! intrinsicdecomp tuning=cycle=2 ! fakesink");
  expect_one(line.errors, "there is no \"cycle\"", "warm-cycles");
}

namespace {

/// 64 x 48 pixels of RGBA: patches of paint under light that falls off and has this slope.
std::vector<uint8_t> picture_in_light(float slope) {
  std::vector<uint8_t> picture;
  for (unsigned y = 0; y < 48; ++y)
    for (unsigned x = 0; x < 64; ++x) {
      const unsigned patch = (x / 16 + 4 * (y / 12)) * 7 % 16;
      const float light = std::log(1 - 0.7F * float(x % 16 + y) / 64);
      for (unsigned c = 0; c < 3; ++c) {
        const float paint = 0.35F + 0.025F * float((patch * (c + 3)) % 16);
        const float lit = paint * std::exp(light * (1 + slope * (0.5F - 0.5F * float(c))));
        picture.push_back(static_cast<uint8_t>(255 * std::pow(lit, 1 / 2.2F)));
      }
      picture.push_back(255);
    }
  return picture;
}

}  // namespace

TEST(Properties, ASlopeOfLightIsMeasuredAnewAfterGrayLight) {
  const std::string caps = VideoHarness::caps("RGBA", 64, 48);
  for (const std::string element : {"intrinsicdecomp", "globalintrinsic"}) {
    VideoHarness harness(element + " adaptive=false", caps, caps);
    const auto measured = [&](VideoHarness& in, float slope) {
      in.process(picture_in_light(slope));
      return stat<double>(in.find(element), "light-color-slope");
    };
    VideoHarness fresh(element + " adaptive=false", caps, caps);
    const double expected = measured(fresh, 0.3F);
    ASSERT_GT(std::abs(measured(harness, 0.6F) - expected), 0.05)
        << "the scenes must be what this test takes them for";
    g_object_set(harness.find(element), "light-color-slope", "0", nullptr);
    EXPECT_EQ(measured(harness, 0.3F), 0);
    g_object_set(harness.find(element), "light-color-slope", "auto", nullptr);
    EXPECT_NEAR(measured(harness, 0.3F), expected, 1e-6) << element;
  }
}

TEST(Properties, StatsSayWhyTheSlopeOfLightWasNotMeasured) {
  const std::string caps = VideoHarness::caps("RGBA", 64, 48);
  VideoHarness harness("intrinsicdecomp adaptive=false", caps, caps);
  const auto skipped = [&](const std::vector<uint8_t>& picture) {
    harness.process(picture);
    return stat<std::string>(harness.find("intrinsicdecomp"), "skipped");
  };
  const auto picture = picture_in_light(0.6F);
  EXPECT_EQ(skipped(picture).find("color of light"), std::string::npos) << "it was";
  expect_contains(skipped(picture), "it is due every 8 frames");
  harness.flush();
  std::vector<uint8_t> gray = picture, even = picture;
  for (size_t i = 0; i < gray.size(); i += 4) {
    gray[i + 1] = gray[i + 2] = gray[i];
    const bool red = i / 32 % 2;
    even[i] = red ? 200 : 100, even[i + 1] = 140, even[i + 2] = red ? 98 : 196;
  }
  expect_contains(skipped(gray), "the frame has no color");
  harness.flush();
  expect_contains(skipped(even), "the frame has no contrast");
}

TEST(Properties, TheSlopeOfLightIsANumberOrAuto) {
  const std::string caps = VideoHarness::caps("RGBA", 64, 48);
  VideoHarness harness("intrinsicdecomp adaptive=false", caps, caps);
  GstElement* element = harness.find("intrinsicdecomp");
  const auto slope = [&] { return property<std::string>(element, "light-color-slope"); };
  const auto in_force = [&] {
    harness.process(random_frame(caps, 1));
    return stat<double>(element, "light-color-slope");
  };
  EXPECT_EQ(slope(), "auto");
  for (const auto& [text, number] : {std::pair{"0.5", 0.5}, {"-1.25", -1.25}, {"0", 0.0}}) {
    g_object_set(element, "light-color-slope", text, nullptr);
    EXPECT_EQ(slope(), text);
    EXPECT_NEAR(in_force(), number, 1e-6);
  }
  EXPECT_NE(stat<std::string>(element, "skipped").find("makes it gray"), std::string::npos);
  g_object_set(element, "light-color-slope", "0.75", nullptr);
  EXPECT_NEAR(in_force(), 0.75, 1e-6) << "again in color";
  g_object_set(element, "light-color-slope", "0", nullptr);
  EXPECT_TRUE(harness.warnings().empty());
  for (const char* wrong : {"", "blue", "2.5", "-3", "nan", "0.5 or so", "1e9"}) {
    g_object_set(element, "light-color-slope", wrong, nullptr);
    expect_one(harness.warnings(), "takes auto or a number from -2 to 2", wrong);
    EXPECT_EQ(slope(), "0") << wrong;
  }
  g_object_set(element, "light-color-slope", "AUTO", nullptr);
  EXPECT_EQ(slope(), "auto");
  const LineResult line =
      run_line("videotestsrc num-buffers=1 ! intrinsicdecomp light-color-slope=blue ! fakesink");
  expect_one(line.errors, "light-color-slope takes auto", "blue");
}

}  // namespace inverse::testing
