// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagesync after the virtual stage, which reports what lit each frame.
#include <map>
#include <mutex>

#include "gst/inverse/inverse_light_stage_meta.h"
#include "tests/elements/element_test.hpp"

namespace inverse::testing {
namespace {

/// What a line's frames were, by the memory that their pixels are in, and what they were called.
struct Truth {
  std::mutex mutex;
  std::map<GstMemory*, guint64> triggers;
  guint64 labeled = 0, mislabeled = 0;
};

void run(const std::string& source, const std::string& sync, Truth& truth) {
  const auto before = [&](GstBuffer* buffer) {
    std::lock_guard lock(truth.mutex);
    if (const GstLightStageMeta* meta = gst_buffer_get_light_stage_meta(buffer))
      truth.triggers[gst_buffer_peek_memory(buffer, 0)] = meta->trigger;
  };
  const auto after = [&](GstBuffer* buffer) {
    std::lock_guard lock(truth.mutex);
    const GstLightStageMeta* meta = gst_buffer_get_light_stage_meta(buffer);
    ++truth.labeled;
    if (!meta || truth.triggers[gst_buffer_peek_memory(buffer, 0)] != meta->trigger)
      ++truth.mislabeled;
  };
  const LineResult result =
      run_line("lightstagetestsrc is-live=false noise=0.01 " + source +
                   " ! video/x-raw,format=RGBA,width=48,height=36 ! lightstagesync name=s " + sync +
                   " ! fakesink sync=false",
               120, [&](GstElement* pipeline) {
                 watch_buffers(find_element(pipeline, "s"), "sink_0", before);
                 watch_buffers(find_element(pipeline, "s"), "src_0", after);
               });
  EXPECT_TRUE(result.eos) << result.first_error();
}

/// `more`: further entries of tuning.
std::string trouble(int seed, const std::string& more = "") {
  return " num-buffers=600 tuning=label=true:drop-rate=0.02:duplicate-rate=0.01:jitter=0.33" +
         more + ":seed=" + std::to_string(seed);
}

TEST(StageLine, APerformanceByTimesAloneAlsoWhereSomeAreLate) {
  for (const int seed : {1, 2, 3}) {
    Truth truth;
    run("program=performance:42" + trouble(seed, ":late-rate=0.02"), "program=performance:42",
        truth);
    EXPECT_EQ(truth.mislabeled, 0u) << seed;
    EXPECT_GT(truth.labeled, 560u) << seed;
  }
}

TEST(StageLine, SingleLightsByTimesAlone) {
  for (const int seed : {4, 5}) {
    Truth truth;
    run("program=static:331" + trouble(seed), "program=static:331", truth);
    EXPECT_EQ(truth.mislabeled, 0u) << seed;
    EXPECT_GT(truth.labeled, 300u) << seed;
  }
}

TEST(StageLine, SingleLightsByIdsAlsoWhereTimesAreLate) {
  for (const int seed : {6, 7}) {
    Truth truth;
    run("program=static:331 frame-ids=true frame-id-bits=16" +
            trouble(seed, ":late-rate=0.02:first-frame-id=65400"),
        // Left to itself it asks the source.
        std::string("program=static:331 frame-id=offset") +
            (seed == 6 ? " tuning=frame-id-bits=16" : ""),
        truth);
    EXPECT_EQ(truth.mislabeled, 0u) << seed;
    EXPECT_GT(truth.labeled, 300u) << seed;
  }
}

}  // namespace
}  // namespace inverse::testing
