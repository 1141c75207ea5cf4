// SPDX-License-Identifier: LGPL-2.1-or-later
// What GST_DEBUG=*intrinsic*:5 shows: device, caps, scene cuts, levels of quality, skipped frames.
#include "tests/elements/element_test.hpp"
#include "tests/elements/log_reader.hpp"

namespace inverse::testing {
namespace {

const std::string kCaps = VideoHarness::caps("RGBA", 64, 48);

}  // namespace

TEST(Log, ReportsDeviceAndCaps) {
  const LogReader log("intrinsicdecomp", GST_LEVEL_INFO);
  VideoHarness harness("intrinsicdecomp", kCaps, kCaps);
  harness.process(random_frame(kCaps, 1));
  EXPECT_GE(log.count(GST_LEVEL_INFO, "device \""), 2u) << "chosen, and configured for frames";
  EXPECT_EQ(log.count(GST_LEVEL_INFO, "frames of 64x48"), 1u);
  EXPECT_GE(log.count(GST_LEVEL_INFO, "caps: in video/x-raw"), 1u);
  EXPECT_EQ(log.count(GST_LEVEL_DEBUG, ""), 0u);
}

TEST(Log, ReportsWhyAFrameIsDecomposedOrSkipped) {
  const LogReader log("intrinsicdecompthesis", GST_LEVEL_LOG);
  VideoHarness harness("intrinsicdecompthesis tuning=irls-iterations=1:pcg-iterations=1", kCaps,
                       kCaps);
  for (int i = 0; i < 20; ++i) harness.process(random_frame(kCaps, 1));
  EXPECT_GE(log.count(GST_LEVEL_DEBUG, "decomposed: the picture changed"), 1u);
  EXPECT_GE(log.count(GST_LEVEL_DEBUG, "skipped, layers reused: repeated picture"), 1u);
  const size_t before = log.count(GST_LEVEL_DEBUG, "decomposed: the picture changed");
  harness.process(random_frame(kCaps, 2));
  EXPECT_EQ(log.count(GST_LEVEL_DEBUG, "decomposed: the picture changed"), before + 1);
  g_object_set(harness.find("intrinsicdecompthesis"), "adaptive", FALSE, nullptr);
  harness.process(random_frame(kCaps, 2));
  EXPECT_GE(log.count(GST_LEVEL_DEBUG, "decomposed: adaptive is off"), 1u);
  EXPECT_GE(log.count(GST_LEVEL_DEBUG, "is done: inverse-stats"), 20u) << "what each frame took";
  EXPECT_GE(log.count(GST_LEVEL_LOG, "frame 0: buffer"), 1u);
}

TEST(Log, ReportsWhyWorkIsNotSkipped) {
  const LogReader log("intrinsicdecomp", GST_LEVEL_DEBUG);
  VideoHarness harness("intrinsicdecomp skip-error=0", kCaps, kCaps);
  harness.process(random_frame(kCaps, 1));
  EXPECT_EQ(log.count(GST_LEVEL_DEBUG, "Skipped: temporal anchor: no previous frame. Run: "), 1u);
  g_object_set(harness.find("intrinsicdecomp"), "skip-error", 0.1, nullptr);
  for (unsigned i = 2; i < 8; ++i) harness.process(random_frame(kCaps, i));
  for (const char* reason :
       {"decomposed: adaptive is off or skip-error is 0.", "decomposed: the picture changed,",
        "edges of all tiles: adaptive is off or skip-error is 0",
        "chroma bins: their effect is measured", "full resolution: not compared yet"})
    EXPECT_GE(log.count(GST_LEVEL_DEBUG, reason), 1u) << reason;
}

TEST(Log, ReportsSceneCuts) {
  const LogReader log("intrinsicdecomp", GST_LEVEL_INFO);
  VideoHarness harness("intrinsicdecomp", kCaps, kCaps);
  for (int i = 0; i < 5; ++i) harness.process(random_frame(kCaps, 1));
  EXPECT_EQ(log.count(GST_LEVEL_INFO, "scene cut"), 0u);
  for (int i = 0; i < 5; ++i) harness.process(random_frame(kCaps, 2));
  EXPECT_EQ(log.count(GST_LEVEL_INFO, "scene cut at frame 5"), 1u);
}

TEST(Log, ReportsChangedQuality) {
  const LogReader log("intrinsicdecomp", GST_LEVEL_INFO);
  VideoHarness harness("intrinsicdecomp quality=low latency-budget=0.01", kCaps, kCaps);
  for (unsigned i = 0; i < 40; ++i) harness.process(random_frame(kCaps, i));
  EXPECT_GE(log.count(GST_LEVEL_INFO, "quality level changed to 0: down: took"), 1u);
}

TEST(Log, WarnsWhereTheBusDoes) {
  const LogReader log("intrinsicdecomp", GST_LEVEL_WARNING);
  VideoHarness harness("intrinsicdecomp", kCaps, kCaps);
  g_object_set(harness.find("intrinsicdecomp"), "tuning", "magic=1", nullptr);
  EXPECT_EQ(log.count(GST_LEVEL_WARNING, "there is no \"magic\""), 1u);
  EXPECT_EQ(harness.warnings().size(), 1u);
}

}  // namespace inverse::testing
