// SPDX-License-Identifier: LGPL-2.1-or-later
// Layers of repeated pictures are reused; target-fps and latency-budget choose the work.
#include "tests/elements/draw.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/elements/layer_of.hpp"
#include "tests/elements/log_reader.hpp"

namespace inverse::testing {
namespace {

constexpr const char* kDecomposers[] = {"intrinsicdecomp", "intrinsicdecompthesis"};

std::string caps_of(int width = 64, int height = 48) {
  return VideoHarness::caps("RGBA", width, height);
}

/// A picture with something to decompose: tiles under a light that falls off.
std::vector<uint8_t> tiles(int width, int height, unsigned shift = 0) {
  return draw(width, height, [&](int x, int y, int c) {
    const unsigned tile =
        (static_cast<unsigned>(x) + shift) / 8 * 5 + static_cast<unsigned>(y) / 8 * 3;
    const int light = 255 - 150 * (x + y) / (width + height);
    return light * static_cast<int>(2 + (tile * static_cast<unsigned>(c + 2)) % 7) / 9;
  });
}

class RepeatedFrames : public ::testing::TestWithParam<const char*> {
 protected:
  /// Sends a picture again and again until its layers are reused; returns the last output.
  std::vector<uint8_t> until_reused(VideoHarness& harness, const std::vector<uint8_t>& picture) {
    for (int i = 0; i < 200; ++i) {
      const auto shown = harness.process(picture);
      if (stat<bool>(harness.find(GetParam()), "reused")) return shown;
    }
    ADD_FAILURE() << "never reused";
    return {};
  }
  bool reused(VideoHarness& harness) { return stat<bool>(harness.find(GetParam()), "reused"); }
};

TEST_P(RepeatedFrames, OfFilmOnAFasterScreenAreSolvedOnce) {
  // 24 pictures on 48 frames, then on 60 (3 : 2).
  for (const std::vector<int>& cadence : {std::vector{2, 2}, {3, 2}}) {
    VideoHarness harness(GetParam(), caps_of(), caps_of());
    int frames = 0, pictures = 0;
    uint64_t reused_before = 0;
    for (unsigned picture = 0; picture < 12; ++picture)
      for (int k = 0; k < cadence[picture % 2]; ++k) {
        harness.process(tiles(64, 48, picture));
        if (picture < 3) reused_before = stat<guint64>(harness.find(GetParam()), "frames-reused");
        if (picture < 3) continue;
        ++frames;
        if (k == 0) ++pictures;
      }
    const uint64_t reused =
        stat<guint64>(harness.find(GetParam()), "frames-reused") - reused_before;
    // Of three frames the third may be solved for, as the picture before came only twice.
    EXPECT_GE(reused, uint64_t(frames - pictures - (cadence[0] > 2 ? pictures / 2 + 1 : 1)));
    EXPECT_LE(reused, uint64_t(frames - pictures));
  }
}

TEST_P(RepeatedFrames, ReuseLayersOnceConverged) {
  VideoHarness harness(GetParam(), caps_of(), caps_of());
  GstElement* tested = harness.find(GetParam());
  if (g_object_class_find_property(G_OBJECT_GET_CLASS(tested), "light-color-slope"))
    g_object_set(tested, "light-color-slope", "0", nullptr);
  const auto picture = tiles(64, 48);
  harness.process(picture);
  EXPECT_FALSE(reused(harness)) << "the first";
  const auto before = harness.process(picture);
  EXPECT_FALSE(reused(harness)) << "the first repeat pays";
  const auto converged = until_reused(harness, picture);
  EXPECT_LE(largest_difference(converged, before), 3);
  const uint64_t count = stat<guint64>(harness.find(GetParam()), "frames-reused");
  for (uint64_t i = 1; i < 10; ++i) {
    EXPECT_EQ(harness.process(picture), converged);
    GstElement* element = harness.find(GetParam());
    EXPECT_TRUE(stat<bool>(element, "reused"));
    EXPECT_EQ(stat<guint64>(element, "frames-reused"), count + i);
    EXPECT_EQ(stat<std::string>(element, "skipped"),
              "method: repeated picture, and its layers have converged");
  }
}

TEST_P(RepeatedFrames, AreComputedIfNothingMayBeSkipped) {
  VideoHarness harness(std::string(GetParam()) + " adaptive=false", caps_of(), caps_of());
  const auto picture = tiles(64, 48);
  for (int i = 0; i < 40; ++i) {
    harness.process(picture);
    GstElement* element = harness.find(GetParam());
    EXPECT_FALSE(stat<bool>(element, "reused"));
    EXPECT_EQ(stat<guint64>(element, "frames-reused"), 0u);
  }
}

TEST_P(RepeatedFrames, AChangedPictureIsComputedAtOnce) {
  VideoHarness harness(std::string(GetParam()) + " show=input", caps_of(), caps_of());
  const auto a = tiles(64, 48), b = tiles(64, 48, 5);
  until_reused(harness, a);
  auto c = a;
  c.back() ^= 0x80;  // a single bit, of the last pixel's alpha
  using Picture = const std::vector<uint8_t>*;
  for (Picture picture : std::initializer_list<Picture>{&a, &b, &b, &b, &b, &a, &b, &a, &a, &c, &a,
                                                        &a, &a, &a, &a, &c})
    EXPECT_LE(largest_difference(harness.process(*picture), *picture), 1);
  EXPECT_FALSE(reused(harness));
}

TEST_P(RepeatedFrames, ChangedPropertiesTakeEffect) {
  VideoHarness harness(GetParam(), caps_of(), caps_of());
  const auto picture = tiles(64, 48);
  const auto reflectance = until_reused(harness, picture);
  g_object_set(harness.find(GetParam()), "show", 2 /* input */, nullptr);
  EXPECT_LE(largest_difference(harness.process(picture), picture), 1);
  EXPECT_TRUE(reused(harness)) << "drawn anew from the same layers";
  g_object_set(harness.find(GetParam()), "show", 0 /* reflectance */, nullptr);
  EXPECT_EQ(harness.process(picture), reflectance);
  const bool thesis = std::string(GetParam()) == "intrinsicdecompthesis";
  if (thesis)
    g_object_set(harness.find(GetParam()), "tuning", "w-shading=300", nullptr);
  else
    g_object_set(harness.find(GetParam()), "shading-weight", 300.0, nullptr);
  EXPECT_GT(largest_difference(harness.process(picture), reflectance), 1);
  EXPECT_FALSE(reused(harness));
  until_reused(harness, picture);
  g_object_set(harness.find(GetParam()), "adaptive", FALSE, nullptr);
  harness.process(picture);
  EXPECT_FALSE(reused(harness));
}

TEST_P(RepeatedFrames, AreDrawnWhereThePictureFollowsEarlierOnes) {
  const LogReader log(GetParam(), GST_LEVEL_DEBUG);  // times stages
  // Clusters go on learning from frames that are alike.
  for (const auto& [show, drawn] : {std::pair{"reflectance", false},
                                    {"shading", false},
                                    {"clusters", true},
                                    {"mosaic", true}}) {
    VideoHarness harness(std::string(GetParam()) + " show=" + show, caps_of(), caps_of());
    const auto picture = tiles(64, 48);
    until_reused(harness, picture);
    harness.process(picture);
    GstElement* element = harness.find(GetParam());
    EXPECT_TRUE(stat<bool>(element, "reused"));
    EXPECT_EQ(find_stat<double>(element, "pack-ms").has_value(), drawn) << show;
  }
}

TEST_P(RepeatedFrames, DoNotOutliveFlushesAndCaps) {
  VideoHarness harness(std::string(GetParam()) + " show=input", caps_of(), {});
  const auto picture = tiles(64, 48);
  until_reused(harness, picture);
  harness.flush();
  harness.process(picture);
  EXPECT_FALSE(reused(harness)) << "after a flush";
  until_reused(harness, picture);
  // The same bytes, and another picture: its rows are of another length.
  harness.set_src_caps(caps_of(48, 64));
  EXPECT_LE(largest_difference(harness.process(picture), picture), 1);
  EXPECT_FALSE(reused(harness));
  until_reused(harness, picture);
  harness.set_src_caps(VideoHarness::caps("BGRA", 48, 64));
  EXPECT_LE(largest_difference(harness.process(picture), picture), 1);
  EXPECT_FALSE(reused(harness));
}

TEST_P(RepeatedFrames, SurviveAFrameThatFails) {
  VideoHarness harness(std::string(GetParam()) + " show=input", caps_of(), caps_of());
  const auto a = tiles(64, 48), b = tiles(64, 48, 5);
  until_reused(harness, a);
  EXPECT_EQ(harness.push(std::vector<uint8_t>(100)), GST_FLOW_ERROR);
  using Picture = const std::vector<uint8_t>*;
  for (Picture picture : std::initializer_list<Picture>{&a, &a, &b, &b, &b})
    EXPECT_LE(largest_difference(harness.process(*picture), *picture), 1);
}

TEST_P(RepeatedFrames, ThePaddingOfRowsIsNotPartOfThePicture) {
  const std::string caps = VideoHarness::caps("RGB", 30, 20);
  VideoHarness harness(std::string(GetParam()) + " show=input", caps, caps);
  auto picture = random_frame(caps, 1);
  until_reused(harness, picture);
  const size_t stride = 92, row = 90;
  for (size_t y = 0; y < 20; ++y) picture[y * stride + row] ^= 0xff;
  harness.process(picture);
  EXPECT_TRUE(reused(harness));
  picture[19 * stride + row - 1] ^= 1;
  harness.process(picture);
  EXPECT_FALSE(reused(harness));
}

TEST_P(RepeatedFrames, ReuseLayersIfLayersAreOutputs) {
  VideoHarness harness(GetParam(), caps_of(), kLayers);
  const auto picture = tiles(64, 48);
  const auto layers = [&](const std::vector<uint8_t>& bytes, GstInverseRole role) {
    auto layer = layer_of(harness.process_buffer(bytes).get(), role);
    EXPECT_FALSE(layer.empty());
    return layer;
  };
  for (int i = 0; i < 200 && !(i > 3 && reused(harness)); ++i)
    layers(picture, GST_INVERSE_ROLE_INTRINSIC);
  ASSERT_TRUE(reused(harness));
  const auto intrinsic = layers(picture, GST_INVERSE_ROLE_INTRINSIC);
  const auto input = layers(picture, GST_INVERSE_ROLE_INPUT);
  EXPECT_EQ(layers(picture, GST_INVERSE_ROLE_INTRINSIC), intrinsic);
  EXPECT_EQ(layers(picture, GST_INVERSE_ROLE_MODEL), intrinsic);
  EXPECT_NE(layers(tiles(64, 48, 5), GST_INVERSE_ROLE_INPUT), input);
  EXPECT_NE(layers(tiles(64, 48, 5), GST_INVERSE_ROLE_INTRINSIC), intrinsic);
}

TEST_P(RepeatedFrames, AnEditOnOneBranchOfATeeLeavesTheOtherAlone) {
  const std::string untouched = " ! intrinsiccompose show=reflectance";
  VideoHarness alone(GetParam() + untouched, caps_of(), caps_of());
  VideoHarness beside(
      std::string(GetParam()) +
          " ! tee name=t t. ! queue ! intrinsicrecolor key=0xffc83c28 tolerance=3 ! "
          "intrinsicrecolor key=0xffc83c28 tolerance=3 ! intrinsiccompose ! fakesink async=false "
          "t. ! queue" +
          untouched,
      caps_of(), caps_of());
  const auto still = tiles(64, 48);
  for (unsigned i = 0; i < 60; ++i) {
    const auto picture = i < 5 || i > 50 ? tiles(64, 48, i) : still;
    EXPECT_EQ(beside.process(picture), alone.process(picture)) << i;
    if (i == 50) {
      EXPECT_TRUE(reused(beside));
    }
  }
}

TEST_P(RepeatedFrames, ComeOutOfAnEditingChainAsTheFirstOfThem) {
  VideoHarness harness(
      std::string(GetParam()) +
          " ! intrinsicrecolor key=0xffc83c28 tolerance=3 target=0xff2040c0 ! intrinsiccompose",
      caps_of(), caps_of());
  const auto picture = tiles(64, 48);
  std::vector<uint8_t> converged;
  for (int i = 0; i < 200; ++i) {
    converged = harness.process(picture);
    if (i > 3 && reused(harness)) break;
  }
  ASSERT_GT(largest_difference(converged, picture), 8) << "the edit does something";
  for (int i = 0; i < 20; ++i)
    EXPECT_LE(largest_difference(harness.process(picture), converged), 1);
}

// A software device builds a kernel when it is first used: half a second where nothing is cached.
TEST(KernelsOfDecomposers, AreBuiltBeforeFramesCome) {
  const NewDevice none_built;
  for (const std::string element : {"intrinsicdecomp", "globalintrinsic"})
    for (const char* format : {"RGBA", "NV12"}) {
      const std::string caps = VideoHarness::caps(format, 320, 240);
      VideoHarness harness(element, caps, caps);
      const auto kernels = [&] { return stat<guint64>(harness.find(element), "kernels"); };
      const auto still = random_frame(caps, 1);
      auto moving = still;
      harness.process(still);
      const uint64_t first = kernels();
      EXPECT_GT(first, 60U);
      for (unsigned k = 0; k < 8; ++k) {
        moving[moving.size() / 3] ^= uint8_t(k + 1);
        harness.process(moving);
      }
      for (int k = 0; k < 24; ++k) harness.process(still);  // whose light, then layers are reused
      // Quality falls if no time is enough.
      g_object_set(harness.find(element), "latency-budget", 0.01, nullptr);
      unsigned levels = 0;
      for (unsigned k = 0; k < 12; ++k) {
        harness.process(random_frame(caps, k));
        levels |= 1U << stat<guint>(harness.find(element), "halvings");
      }
      EXPECT_TRUE(levels & 4U) << "quarter resolution must have come";
      EXPECT_EQ(kernels(), first) << element << " " << format;
      EXPECT_TRUE(harness.errors().empty());
    }
}

INSTANTIATE_TEST_SUITE_P(All, RepeatedFrames, ::testing::ValuesIn(kDecomposers),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace inverse::testing
