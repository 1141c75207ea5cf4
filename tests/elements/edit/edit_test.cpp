// SPDX-License-Identifier: LGPL-2.1-or-later
// Editors and compose: what comes back unedited, what an edit touches, what is refused.
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/elements/edit/edit_fixture.hpp"
#include "tests/elements/layer_of.hpp"
#include "tests/srgb.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {
namespace {

constexpr const char* kChain =
    "intrinsicdecomp ! intrinsicrecolor key=0xffc83c28 ! intrinsiccompose";

/// RGBA, left half of one color, right half of another, light falling off to the bottom, with the
/// noise of a camera.
std::vector<uint8_t> two_colors(int width, int height, std::array<int, 3> left,
                                std::array<int, 3> right) {
  std::mt19937 random(4);
  return draw(width, height, [&](int x, int y, int c) {
    const int color = (x < width / 2 ? left : right)[static_cast<size_t>(c)];
    const int light = color * (3 * height - 2 * y) / (3 * height);
    return std::clamp(light + static_cast<int>(random() % 3) - 1, 0, 255);
  });
}

std::array<double, 3> mean_of_half(const std::vector<uint8_t>& frame, int width, bool right) {
  std::array<double, 3> sum{};
  double count = 0;
  for (size_t i = 0; i + 3 < frame.size(); i += 4)
    if ((static_cast<int>(i / 4) % width >= width / 2) == right) {
      for (size_t c = 0; c < 3; ++c) sum[c] += frame[i + c];
      ++count;
    }
  for (double& s : sum) s /= count;
  return sum;
}

}  // namespace

TEST(Compose, UneditedChainReturnsItsInput) {
  for (const char* decomposer : {"intrinsicdecomp", "intrinsicdecompthesis"})
    for (const char* format : {"RGBA", "BGRx", "RGB", "GRAY8"})
      for (const auto& [width, height] : {std::pair{15, 10}, {349, 287}, {1, 1}, {2, 3}, {33, 1}}) {
        if (std::string(decomposer) == "intrinsicdecompthesis" && width > 33) continue;  // slow
        const std::string caps = VideoHarness::caps(format, width, height);
        VideoHarness harness(std::string(decomposer) + " ! intrinsiccompose", caps, caps);
        for (unsigned seed = 0; seed < 2; ++seed) {
          auto frame = random_frame(caps, seed);
          if (std::string(format) == "BGRx")
            for (size_t i = 3; i < frame.size(); i += 4) frame[i] = 255;  // what is written there
          EXPECT_LE(largest_difference(visible(caps, harness.process(frame)), visible(caps, frame)),
                    1)
              << decomposer << " " << caps;
        }
      }
}

TEST(Compose, UneditedChainKeepsBlackAndWhite) {
  const std::string caps = VideoHarness::caps("RGB", 64, 48);
  VideoHarness harness("intrinsicdecomp ! intrinsicrecolor strength=0 ! intrinsiccompose", caps,
                       caps);
  for (const int value : {0, 1, 128, 254, 255}) {
    const auto frame = flat_frame(caps, static_cast<uint8_t>(value));
    EXPECT_LE(largest_difference(harness.process(frame), frame), 1) << value;
  }
}

TEST(Recolor, ChangesTheKeyedRegionOnly) {
  const int width = 96, height = 64;
  const std::string caps = VideoHarness::caps("RGBA", width, height);
  const auto frame = two_colors(width, height, {210, 60, 50}, {60, 90, 200});
  VideoHarness harness(
      "intrinsicdecomp ! intrinsicrecolor key=0xffd23c32 target=0xff32c83c ! intrinsiccompose",
      caps, caps);
  const auto edited = harness.process(frame);
  EXPECT_LE(half_difference(frame, edited, width, true), 1) << "the other color changed";
  const auto before = mean_of_half(frame, width, false), after = mean_of_half(edited, width, false);
  EXPECT_LT(after[0], before[0] - 50);
  EXPECT_GT(after[1], before[1] + 50);
  // The light stays: darker at the bottom than at the top, by as much as before.
  const auto green = [&](int y) {
    double sum = 0;
    for (int x = 4; x < width / 2 - 4; ++x)
      sum += edited[(static_cast<size_t>(y) * width + x) * 4 + 1];
    return sum;
  };
  EXPECT_LT(green(height - 3), 0.6 * green(2));
}

// Every element of a chain with queues has a thread, and planes go back and forth between them.
TEST(Recolor, QueuesBetweenEditorsLeaveEachFrameItsOwnMaskAndColors) {
  constexpr int kFrames = 60, kWidth = 96, kHeight = 64;
  const std::string caps = VideoHarness::caps("RGBA", kWidth, kHeight);
  std::vector<std::vector<uint8_t>> frames;
  for (int n = 0; n < kFrames; ++n)
    frames.push_back(two_colors(kWidth, kHeight, {200, 40 + n, 60}, {60, 220 - 2 * n, 50 + n}));
  for (const char* show : {"composed", "mask"}) {
    const auto run = [&](const std::string& queue) {
      VideoHarness harness(
          "intrinsicdecomp adaptive=false light-color-slope=0 " + queue +
              "! intrinsicrecolor key=0xffc83c3c tolerance=.5 write-mask=true " + queue +
              "! intrinsicrecolor key=0xff2864c8 tolerance=1 use-mask=true write-mask=true "
              "target=0xff32c83c " +
              queue + "! intrinsiccompose show=" + show,
          caps, caps);
      for (const auto& frame : frames) EXPECT_EQ(harness.push(frame), GST_FLOW_OK);
      std::vector<std::vector<uint8_t>> shown;
      for (int n = 0; n < kFrames; ++n) shown.push_back(harness.pull());
      return shown;
    };
    const auto expected = run("");
    EXPECT_NE(expected.front(), expected.back());
    for (int round = 0; round < 5; ++round) {
      const auto queued = run("! queue ");
      for (size_t n = 0; n < kFrames; ++n)
        ASSERT_EQ(largest_difference(queued[n], expected[n]), 0) << show << ", frame " << n;
    }
  }
}

TEST(Recolor, AClusterIsRecoloredByItsIndex) {
  const int width = 96, height = 64;
  const std::string caps = VideoHarness::caps("RGBA", width, height);
  const auto frame = two_colors(width, height, {210, 60, 50}, {60, 90, 200});
  VideoHarness harness(
      "intrinsicdecomp light-color-slope=0 ! "
      "intrinsicrecolor clusters=4 softness=0 cluster=0 target=0xff32c83c ! "
      "intrinsiccompose",
      caps, caps);
  GstElement* recolor = harness.find("intrinsicrecolor");
  bool left = false, right = false;
  for (int cluster = 0; cluster < 4; ++cluster) {
    g_object_set(recolor, "cluster", cluster, nullptr);
    const auto edited = harness.process(frame);
    const bool in_left = half_difference(frame, edited, width, false) > 20;
    const bool in_right = half_difference(frame, edited, width, true) > 20;
    EXPECT_FALSE(in_left && in_right) << "cluster " << cluster << " is in both colors";
    left |= in_left;
    right |= in_right;
  }
  EXPECT_TRUE(left && right) << "a color belongs to no cluster";
  EXPECT_TRUE(harness.warnings().empty());
  g_object_set(recolor, "cluster", 7, nullptr);
  for (int i = 0; i < 3; ++i) harness.process(frame);
  expect_one(harness.warnings(), "cluster=7 of clusters=4 selects nothing");
  GstStructure* stats = nullptr;
  g_object_get(recolor, "stats", &stats, nullptr);
  const GValue* clusters = gst_structure_get_value(stats, "clusters");
  ASSERT_NE(clusters, nullptr);
  ASSERT_EQ(gst_value_array_get_size(clusters), 4u);
  // One of them has the chromaticity of the left half, one that of the right.
  const auto chromaticity = [](std::array<int, 3> code) {
    std::array<float, 3> light{};
    float sum = 0;
    for (size_t c = 0; c < 3; ++c) sum += light[c] = srgb_light(static_cast<float>(code[c]) / 255);
    for (float& l : light) l /= sum;
    return light;
  };
  const auto apart = [&](std::array<int, 3> a, std::array<int, 3> b) {
    const auto one = chromaticity(a), other = chromaticity(b);
    float largest = 0;
    for (size_t c = 0; c < 3; ++c) update_max(largest, std::abs(one[c] - other[c]));
    return largest;
  };
  float red = 1, blue = 1;
  for (guint i = 0; i < 4; ++i) {
    const guint color = g_value_get_uint(gst_value_array_get_value(clusters, i));
    const std::array<int, 3> code{int(color >> 16 & 255), int(color >> 8 & 255), int(color & 255)};
    red = std::min(red, apart(code, {210, 60, 50}));
    blue = std::min(blue, apart(code, {60, 90, 200}));
  }
  EXPECT_LT(red, 0.05F) << gst_structure_to_string(stats);
  EXPECT_LT(blue, 0.02F) << gst_structure_to_string(stats);
  gst_structure_free(stats);
}

TEST(Recolor, ABaseColorOfVideoWithoutAnyIsWarnedOfOnce) {
  const auto warnings = [](const std::string& pattern, const std::string& decomposer) {
    const auto result = run_line("videotestsrc num-buffers=8 pattern=" + pattern +
                                 " ! video/x-raw,width=64,height=48 ! " + decomposer +
                                 " ! intrinsicrecolor base-color=2 ! intrinsiccompose ! fakesink");
    EXPECT_TRUE(result.eos) << result.first_error();
    return result.warnings;
  };
  const auto found = warnings("smpte", "intrinsicdecomp");
  expect_one(found, "globalintrinsic");
  EXPECT_TRUE(found.at(0).starts_with("intrinsicrecolor: base-color=2 selects nothing"));
  EXPECT_TRUE(warnings("smpte", "globalintrinsic").empty());
  EXPECT_TRUE(warnings("gradient", "globalintrinsic").empty()) << "black and white";
}

TEST(Recolor, PropertiesTakeEffectWhilePlaying) {
  const int width = 64, height = 48;
  const std::string caps = VideoHarness::caps("RGBA", width, height);
  const auto frame = two_colors(width, height, {210, 60, 50}, {60, 90, 200});
  VideoHarness harness(kChain, caps, caps);
  g_object_set(harness.find("intrinsicdecomp"), "light-color-slope", "0", nullptr);
  GstElement* recolor = harness.find("intrinsicrecolor");
  GstElement* compose = harness.find("intrinsiccompose");
  g_object_set(recolor, "key", 0xffd23c32u, "target", 0xff32c83cu, nullptr);
  EXPECT_GT(half_difference(harness.process(frame), frame, width, false), 50);
  g_object_set(recolor, "strength", 0.0f, nullptr);
  EXPECT_LE(largest_difference(harness.process(frame), frame), 1);
  g_object_set(recolor, "strength", 1.0f, "key", 0xff3c5ac8u, nullptr);
  const auto blue_edited = harness.process(frame);
  EXPECT_GT(half_difference(blue_edited, frame, width, true), 50);
  EXPECT_LE(half_difference(blue_edited, frame, width, false), 1);
  g_object_set(compose, "strength", 0.0f, nullptr);
  EXPECT_LE(largest_difference(harness.process(frame), frame), 1);
  g_object_set(compose, "strength", 1.0f, "show", 3 /* input */, nullptr);
  EXPECT_LE(largest_difference(harness.process(frame), frame), 1);
  g_object_set(compose, "show", 5 /* difference */, nullptr);
  const auto difference = harness.process(frame);
  const auto gray = flat_frame(caps, 128);
  for (size_t i = 0; i < difference.size(); ++i)
    if (i % 4 != 3 && static_cast<int>(i / 4) % width < width / 2) {
      ASSERT_NEAR(difference[i], 128, 1) << "the unedited half is not middle gray";
    }
  EXPECT_GT(half_difference(difference, gray, width, true), 20);
  g_object_set(recolor, "write-mask", TRUE, nullptr);
  g_object_set(compose, "show", 4 /* mask */, nullptr);
  const auto mask = harness.process(frame);
  EXPECT_GT(mean_of_half(mask, width, true)[0], 250);
  EXPECT_LT(mean_of_half(mask, width, false)[0], 5);
}

TEST(Recolor, AMaskConfinesTheNextEditor) {
  // The first selects blue without changing it; the second would recolor everything.
  const int width = 64, height = 48;
  const std::string caps = VideoHarness::caps("RGBA", width, height);
  const auto frame = two_colors(width, height, {210, 60, 50}, {60, 90, 200});
  const std::string first =
      "intrinsicdecomp ! intrinsicrecolor key=0xff3c5ac8 strength=0 write-mask=true ! ";
  const std::string second = "intrinsicrecolor key=0xffc83c28 tolerance=4.25 target=0xff32c83c";
  VideoHarness masked(first + second + " ! intrinsiccompose", caps, caps);
  const auto confined = masked.process(frame);
  EXPECT_GT(half_difference(confined, frame, width, true), 50);
  EXPECT_LE(half_difference(confined, frame, width, false), 1);
  VideoHarness free(first + second + " use-mask=false ! intrinsiccompose", caps, caps);
  EXPECT_GT(half_difference(free.process(frame), frame, width, false), 50);
}

TEST(Recolor, AnEmptySelectionIsAnEmptyMask) {
  const std::string caps = VideoHarness::caps("RGBA", 32, 24);
  VideoHarness harness(
      "intrinsicdecomp ! intrinsicrecolor write-mask=true ! intrinsiccompose show=mask", caps,
      caps);
  const auto mask = harness.process(random_frame(caps, 1));
  EXPECT_LE(mean_of_half(mask, 32, true)[0], 0);
  EXPECT_LE(mean_of_half(mask, 32, false)[0], 0);
}

TEST(Recolor, EveryEditorOfAChainWorksInPlaceWithoutTouchingTheModel) {
  const int width = 48, height = 32;
  const std::string caps = VideoHarness::caps("RGBA", width, height);
  const auto frame = two_colors(width, height, {210, 60, 50}, {60, 90, 200});
  VideoHarness plain("intrinsicdecomp", caps, kLayers);
  VideoHarness chain(
      "intrinsicdecomp ! intrinsicrecolor key=0xffc83c28 tolerance=3 ! intrinsicrecolor "
      "key=0xffc83c28 tolerance=3 "
      "target=0xff32c83c ! intrinsicrecolor key=0xffc83c28 tolerance=3 target=0xffffffff",
      caps, kLayers);
  for (int i = 0; i < 6; ++i) {
    const Buffer a = plain.process_buffer(frame), b = chain.process_buffer(frame);
    const auto same = [&](GstInverseRole role) {
      return layer_of(a.get(), role) == layer_of(b.get(), role);
    };
    EXPECT_TRUE(same(GST_INVERSE_ROLE_MODEL));
    EXPECT_TRUE(same(GST_INVERSE_ROLE_INPUT));
    EXPECT_FALSE(same(GST_INVERSE_ROLE_INTRINSIC));
  }
}

TEST(Recolor, ALongerChainOfEditorsTakesNoMorePlanes) {
  const int width = 128, height = 96;
  const std::string caps = VideoHarness::caps("RGBA", width, height);
  const auto frame = random_frame(caps, 1);
  const auto bytes_with = [&](int editors) {
    std::string line = "intrinsicdecomp";
    for (int i = 0; i < editors; ++i) line += " ! intrinsicrecolor key=0xffc83c28";
    VideoHarness harness(line + " ! intrinsiccompose", caps, caps);
    for (int i = 0; i < 6; ++i) EXPECT_EQ(harness.process(frame).size(), frame.size());
    return static_cast<int64_t>(stat<guint64>(harness.find("intrinsiccompose"), "device-bytes"));
  };
  const int64_t plane = static_cast<int64_t>(width) * height * 16;
  EXPECT_GE(bytes_with(1), bytes_with(0) + plane) << "the first editor needs a plane of its own";
  EXPECT_LT(bytes_with(5), bytes_with(1) + plane);
}

TEST(Recolor, AnEditOnOneBranchOfATeeLeavesTheOtherAlone) {
  const std::string source =
      "videotestsrc num-buffers=12 pattern=ball ! video/x-raw,format=RGBA,width=64,height=48 ! "
      "intrinsicdecomp ! ";
  const std::string untouched = "intrinsiccompose show=reflectance ! appsink name=out";
  const auto alone = run_line(source + untouched);
  const auto beside =
      run_line(source +
               "tee name=t t. ! queue ! intrinsicrecolor key=0xffc83c28 tolerance=3 ! "
               "intrinsicrecolor key=0xffc83c28 tolerance=3 ! intrinsiccompose ! fakesink "
               "t. ! queue ! " +
               untouched);
  ASSERT_TRUE(alone.eos && beside.eos) << beside.first_error();
  ASSERT_EQ(alone.frames.size(), 12u);
  EXPECT_EQ(alone.frames, beside.frames);
}

TEST(Editors, WithoutADecomposerThereIsOneErrorThatNamesIt) {
  for (const std::string editor :
       {"intrinsicrecolor", "intrinsickey", "intrinsictone", "intrinsicstylize", "intrinsicrelight",
        "intrinsiccompose", "intrinsicsplit"}) {
    const std::string caps = VideoHarness::caps("RGBA", 32, 24);
    VideoHarness harness(
        editor == "intrinsicsplit" ? "intrinsicsplit name=s s.shading ! identity" : editor, caps);
    harness.push(random_frame(caps, 1));
    harness.push(random_frame(caps, 2));
    expect_one(harness.errors(), editor + " works on layers; insert intrinsicdecomp");
  }
}

TEST(Editors, AWholeLineWithoutADecomposerIsAnErrorToo) {
  for (const std::string editor : {"intrinsicrecolor key=0xffc83c28 ! intrinsiccompose",
                                   "intrinsiccompose", "intrinsicsplit name=s s.shading ! queue"}) {
    const auto result = run_line("videotestsrc num-buffers=3 ! video/x-raw,width=32,height=24 ! " +
                                 editor + " ! fakesink");
    expect_contains(result.first_error(), "works on layers; insert intrinsicdecomp");
  }
}

TEST(Editors, AMissingMaskIsOneErrorWithItsRemedy) {
  const std::string caps = VideoHarness::caps("RGBA", 32, 24);
  VideoHarness harness("intrinsicdecomp ! intrinsiccompose show=mask", caps, caps);
  EXPECT_EQ(harness.push(random_frame(caps, 1)), GST_FLOW_ERROR);
  expect_one(harness.errors(), "write-mask=true");
}

TEST(Editors, FramesFlowAfterCapsChangesAndFlushes) {
  VideoHarness harness(std::string(kChain) + " ! capsfilter caps=video/x-raw,format=RGBA",
                       VideoHarness::caps("RGBA", 32, 24));
  GstElement* recolor = harness.find("intrinsicrecolor");
  for (int i = 0; i < 16; ++i) {
    g_object_set(recolor, "strength", i % 2 ? 1.0f : 0.0f, "cluster", i % 3 - 1, nullptr);
    const std::string caps = VideoHarness::caps("RGBA", 16 + 6 * i, 60 - 3 * i);
    harness.set_src_caps(caps);
    const auto frame = random_frame(caps, static_cast<unsigned>(i));
    const auto shown = harness.process(frame);
    ASSERT_EQ(shown.size(), frame.size()) << caps;
    if (i % 2 == 0) {
      EXPECT_LE(largest_difference(shown, frame), 1) << caps;
    }
    if (i % 4 == 3) harness.flush();
  }
  EXPECT_TRUE(harness.errors().empty());
}

TEST(Editors, AnotherRateChangesNothing) {
  const std::string caps = "video/x-raw,format=RGBA,width=40,height=30,framerate=";
  VideoHarness harness(std::string(kChain) + " ! capsfilter caps=video/x-raw,format=RGBA",
                       caps + "25/1");
  for (int i = 0; i < 6; ++i) {
    if (i == 3) harness.set_src_caps(caps + "12/1");
    ASSERT_FALSE(harness.process(random_frame(caps + "25/1", 1)).empty());
  }
  // Those that hand layers on do not wait for the device: their last frames may not count yet.
  for (const char* name : {"intrinsicdecomp", "intrinsicrecolor"})
    EXPECT_GT(stat<guint64>(harness.find(name), "frames"), 3u) << name;
  EXPECT_EQ(stat<guint64>(harness.find("intrinsiccompose"), "frames"), 6u);
  EXPECT_TRUE(harness.errors().empty());
}

TEST(Editors, LayersFromElsewhereMayHaveAnyValue) {
  // An element of another plugin between ours: not-a-numbers must not reach the picture.
  const std::string caps = VideoHarness::caps("RGBA", 16, 8);
  VideoHarness decomposer("intrinsicdecomp", caps, kLayers);
  GstBuffer* buffer =
      gst_buffer_make_writable(decomposer.process_buffer(random_frame(caps, 1)).release());
  std::vector<float> odd(16 * 8 * 4);
  const float values[] = {NAN, INFINITY, -INFINITY, -1.0f, 1e30f, 0.0f, 1e-40f};
  for (size_t i = 0; i < odd.size(); ++i) odd[i] = values[i % std::size(values)];
  for (const GstInverseRole role : {GST_INVERSE_ROLE_INTRINSIC, GST_INVERSE_ROLE_MASK})
    ASSERT_TRUE(replace_layer(buffer, role, odd));
  VideoHarness editor("intrinsicrecolor key=0xffc83c28 tolerance=3 write-mask=true",
                      caps_out_of(decomposer.harness()), kLayers);
  ASSERT_EQ(gst_harness_push(editor.harness(), buffer), GST_FLOW_OK);
  const Buffer edited(gst_harness_pull(editor.harness()));
  for (const GstInverseRole role : {GST_INVERSE_ROLE_INTRINSIC, GST_INVERSE_ROLE_MASK}) {
    const auto layer = layer_of(edited.get(), role);
    ASSERT_EQ(layer.size(), odd.size());
    for (const float value : layer) ASSERT_TRUE(std::isfinite(value));
  }
}

}  // namespace inverse::testing
