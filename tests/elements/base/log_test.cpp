// SPDX-License-Identifier: LGPL-2.1-or-later
// What GST_DEBUG=*intrinsic*:5 shows: device, caps, scene cuts, levels of quality, skipped frames.
#include <algorithm>
#include <mutex>

#include "tests/elements/element_test.hpp"

namespace inverse::testing {
namespace {

/// Takes down what an element logs while it lives.
class LogReader {
 public:
  explicit LogReader(const char* category, GstDebugLevel level) : category_(category) {
    gst_debug_set_threshold_for_name(category, level);
    gst_debug_add_log_function(take, this, nullptr);
  }
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;
  ~LogReader() {
    gst_debug_remove_log_function_by_data(this);
    gst_debug_unset_threshold_for_name(category_.c_str());
  }

  /// Messages of this level with this text.
  size_t count(GstDebugLevel level, const std::string& text) const {
    std::lock_guard lock(mutex_);
    return static_cast<size_t>(std::count_if(lines_.begin(), lines_.end(), [&](const auto& line) {
      return line.first == level && line.second.find(text) != std::string::npos;
    }));
  }
  bool empty() const {
    std::lock_guard lock(mutex_);
    return lines_.empty();
  }

 private:
  static void take(GstDebugCategory* category, GstDebugLevel level, const gchar*, const gchar*,
                   gint, GObject*, GstDebugMessage* message, gpointer self) {
    auto& reader = *static_cast<LogReader*>(self);
    if (reader.category_ != gst_debug_category_get_name(category)) return;
    std::lock_guard lock(reader.mutex_);
    reader.lines_.emplace_back(level, gst_debug_message_get(message));
  }

  std::string category_;
  mutable std::mutex mutex_;
  std::vector<std::pair<GstDebugLevel, std::string>> lines_;
};

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
  EXPECT_GE(log.count(GST_LEVEL_DEBUG, "decomposed: it is compared with no frame before"), 1u);
  EXPECT_GE(log.count(GST_LEVEL_DEBUG, "skipped, layers reused: the picture came again"), 1u);
  const size_t before = log.count(GST_LEVEL_DEBUG, "decomposed: the picture changed");
  harness.process(random_frame(kCaps, 2));
  EXPECT_EQ(log.count(GST_LEVEL_DEBUG, "decomposed: the picture changed"), before + 1);
  g_object_set(harness.find("intrinsicdecompthesis"), "adaptive", FALSE, nullptr);
  harness.process(random_frame(kCaps, 2));
  EXPECT_GE(log.count(GST_LEVEL_DEBUG, "decomposed: adaptive is off"), 1u);
  EXPECT_GE(log.count(GST_LEVEL_DEBUG, "is done: inverse-stats"), 20u) << "what each frame took";
  EXPECT_GE(log.count(GST_LEVEL_LOG, "frame 0: buffer"), 1u);
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
