// SPDX-License-Identifier: LGPL-2.1-or-later
// What an element makes of the stream around it: gaps, devices that go, latency, stats.
#include <map>
#include <thread>

#include "tests/elements/element_test.hpp"
#include "tests/elements/layer_of.hpp"
#include "tests/elements/log_reader.hpp"

namespace inverse::testing {
namespace {

bool history_of(VideoHarness& harness) {
  return stat<bool>(harness.find("intrinsicdecomp"), "history");
}

}  // namespace

TEST(Stream, DroppedFramesDoNotDiscardHistory) {
  const std::string caps = VideoHarness::caps("RGBA", 40, 30);
  VideoHarness harness("intrinsicdecomp", caps, caps);
  const auto frame = random_frame(caps, 1);
  harness.process(frame);
  EXPECT_FALSE(history_of(harness));
  // What a leaky queue or QoS does to every frame of a machine that cannot keep up.
  for (int i = 1; i < 4; ++i) {
    harness.push_after_gap(frame, static_cast<GstClockTime>(i) * 3 * GST_SECOND / 25);
    EXPECT_TRUE(history_of(harness)) << i;
  }
  harness.push_after_gap(frame, 60 * GST_SECOND);
  EXPECT_FALSE(history_of(harness)) << "a minute is another scene";
  harness.push_after_gap(frame, GST_SECOND);
  EXPECT_FALSE(history_of(harness)) << "so is the past";
}

TEST(Stream, StatsCountTheWorkOfAFrame) {
  constexpr guint64 kFrame = 64 * 48 * 4;
  const std::string caps = VideoHarness::caps("RGBA", 64, 48);
  VideoHarness pictures("intrinsicdecomp", caps, caps);
  pictures.process(random_frame(caps, 1));
  GstElement* element = pictures.find("intrinsicdecomp");
  EXPECT_GT(stat<guint>(element, "dispatches"), 20u);
  EXPECT_GT(stat<guint>(element, "barriers"), 10u);
  EXPECT_GE(stat<guint64>(element, "bytes-transferred"), stat<guint>(element, "transfers"));
  EXPECT_GE(stat<guint64>(element, "bytes-uploaded"), kFrame) << "tables as well";
  EXPECT_EQ(stat<guint64>(element, "bytes-downloaded"), 0u) << "drawn where it goes out";

  VideoHarness chain("intrinsicdecomp ! intrinsiccompose", caps, caps);
  chain.process(random_frame(caps, 1));
  element = chain.find("intrinsiccompose");
  EXPECT_EQ(stat<guint64>(element, "bytes-uploaded"), 0u);
  EXPECT_EQ(stat<guint64>(element, "bytes-downloaded"), kFrame) << "the device was unknown";
  chain.process(random_frame(caps, 2));
  EXPECT_EQ(stat<guint64>(element, "bytes-downloaded"), 0u);
}

TEST(Stream, StagesAreTimedWhileTheCategoryLogsAtDebug) {
  const std::string caps = VideoHarness::caps("RGBA", 64, 48);
  VideoHarness harness("intrinsicdecomp", caps, caps);
  GstElement* element = harness.find("intrinsicdecomp");
  for (unsigned i = 0; i < 3; ++i) {
    harness.process(random_frame(caps, i));
    EXPECT_FALSE(find_stat<double>(element, "unpack-ms")) << "stats are read, the log is not";
    EXPECT_GT(stat<double>(element, "device-ms"), 0) << "of all stages";
  }
  {
    const LogReader log("intrinsicdecomp", GST_LEVEL_DEBUG);
    harness.process(random_frame(caps, 3));
    EXPECT_GT(stat<double>(element, "unpack-ms"), 0);
    EXPECT_GT(stat<double>(element, "device-ms"), stat<double>(element, "unpack-ms"));
  }
  harness.process(random_frame(caps, 4));
  EXPECT_FALSE(find_stat<double>(element, "unpack-ms"));
}

TEST(Stream, StatsReportCompletedFramesIfLayersAreOutputs) {
  const std::string caps = VideoHarness::caps("RGBA", 64, 48);
  VideoHarness harness("intrinsicdecomp", caps, kLayers);
  const LogReader log("intrinsicdecomp", GST_LEVEL_DEBUG);  // times stages
  guint64 last = 0;
  for (unsigned i = 0; i < 8; ++i) {
    ASSERT_NE(harness.process_buffer(random_frame(caps, i % 2)), nullptr);
    GstElement* element = harness.find("intrinsicdecomp");
    if (!find_stat<double>(element, "device-ms")) continue;
    EXPECT_GE(stat<guint64>(element, "frames"), last);
    last = stat<guint64>(element, "frames");
    EXPECT_EQ(stat<guint>(element, "tiles"), 12u);
    EXPECT_LE(stat<guint>(element, "tiles-evaluated"), 12u);
    const double change = stat<double>(element, "change");
    EXPECT_TRUE(change >= 0 && change < 10) << change;
    EXPECT_GT(stat<double>(element, "device-ms"), 0);
    // Stages of every cycle are reported as their sum.
    double stages = 0;
    const auto stats = property<GstStructure*>(element, "stats");
    for (int i = 0; i < gst_structure_n_fields(stats); ++i) {
      const std::string name = gst_structure_nth_field_name(stats, static_cast<guint>(i));
      if (name.ends_with("-ms") && name != "device-ms" && name != "wall-ms")
        stages += field<double>(stats, name.c_str()).value();
    }
    EXPECT_NEAR(stages, field<double>(stats, "device-ms").value(), 1e-6);
    for (const char* stage : {"unpack-ms", "guide-ms", "prior-ms", "assemble-ms", "operators-ms",
                              "descend-ms", "cells-ms", "ascend-ms", "layers-ms"})
      EXPECT_TRUE(field<double>(stats, stage)) << stage;
    gst_structure_free(stats);
  }
  EXPECT_GE(last, 5u) << "at most three frames are in flight";
}

TEST(Stream, LatencyIsAnnouncedWhenItChanges) {
  VideoHarness harness("intrinsicdecomp", VideoHarness::caps("RGBA", 16, 12));
  const auto announced = [&] { return texts_of(harness.bus(), GST_MESSAGE_LATENCY).size(); };
  harness.process(random_frame(VideoHarness::caps("RGBA", 16, 12), 1));
  EXPECT_EQ(announced(), 1u);
  const std::string slower = "video/x-raw, format=RGBA, width=16, height=12, framerate=5/1";
  harness.set_src_caps(slower);
  harness.process(random_frame(slower, 1));
  EXPECT_EQ(announced(), 1u);
  EXPECT_EQ(gst_harness_query_latency(harness.harness()), 200 * GST_MSECOND);
}

// As streams from networks and screens have it.
TEST(Stream, LatencyWithoutARateIsThatOfAUsualOne) {
  VideoHarness harness("intrinsicdecomp", VideoHarness::caps("RGBA", 16, 12));
  const std::string without = "video/x-raw, format=RGBA, width=16, height=12, framerate=0/1";
  harness.set_src_caps(without);
  harness.process(random_frame(without, 1));
  EXPECT_EQ(gst_harness_query_latency(harness.harness()), 40 * GST_MSECOND);
}

TEST(Stream, AnEditingLineInSystemMemoryOpensOneDevice) {
  static std::map<std::string, int> contexts;
  contexts.clear();
  const auto result = run_line(
      "videotestsrc num-buffers=3 ! video/x-raw,width=32,height=24 ! intrinsicdecomp ! "
      "intrinsicrecolor key=0xffc83c28 ! "
      "intrinsiccompose ! fakesink",
      60, [](GstElement* pipeline) {
        GstBus* bus = gst_element_get_bus(pipeline);
        gst_bus_set_sync_handler(
            bus,
            [](GstBus*, GstMessage* message, gpointer) {
              if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_HAVE_CONTEXT) {
                GstContext* context = nullptr;
                gst_message_parse_have_context(message, &context);
                ++contexts[gst_context_get_context_type(context)];
                gst_context_unref(context);
              }
              return GST_BUS_PASS;
            },
            nullptr, nullptr);
        gst_object_unref(bus);
      });
  EXPECT_TRUE(result.eos) << result.first_error();
  EXPECT_EQ(contexts["gst.inverse.device"], 1);
  EXPECT_EQ(contexts.size(), 1u) << "GStreamer's own Vulkan device is for those who need it";
}

// No frame for a time: an empty buffer with the flag GAP. It goes where frames go, and means no new
// scene.
TEST(Stream, GapsPassThroughEveryElement) {
  const std::string caps = VideoHarness::caps("RGBA", 40, 30);
  const auto frame = random_frame(caps, 1);
  for (const char* line :
       {"intrinsicdecomp", "intrinsicdecompthesis", "intrinsicdecomp ! intrinsiccompose",
        "intrinsicdecomp ! intrinsicrecolor key=0xffc83c28 write-mask=true ! intrinsiccompose "
        "show=mask",
        "intrinsicdecomp ! intrinsicsplit name=s s.shading ! identity"}) {
    VideoHarness harness(line, caps);
    for (int i = 0; i < 6; ++i) {
      const bool gap = i % 3 == 0;  // the first of all, too
      GstBuffer* buffer =
          gap ? gst_buffer_new() : gst_buffer_new_memdup(frame.data(), frame.size());
      GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(i) * GST_SECOND / 25;
      GST_BUFFER_DURATION(buffer) = GST_SECOND / 25;
      // A frame that is flagged so is a frame all the same.
      if (gap || i == 4) GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_GAP);
      ASSERT_EQ(gst_harness_push(harness.harness(), buffer), GST_FLOW_OK) << line << ", " << i;
      const Buffer pulled(gst_harness_try_pull(harness.harness()));
      GstBuffer* out = pulled.get();
      ASSERT_NE(out, nullptr) << line << ", " << i;
      EXPECT_EQ(GST_BUFFER_PTS(out), static_cast<GstClockTime>(i) * GST_SECOND / 25) << line;
      EXPECT_EQ(GST_BUFFER_DURATION(out), GST_SECOND / 25) << line;
      EXPECT_EQ(static_cast<bool>(GST_BUFFER_FLAG_IS_SET(out, GST_BUFFER_FLAG_GAP)), gap)
          << line << ", " << i;
      EXPECT_EQ(gst_buffer_get_size(out) == 0, gap) << line << ", " << i;
    }
    const auto errors = harness.errors();
    EXPECT_TRUE(errors.empty()) << line << ": " << errors[0];
    if (harness.find("intrinsicdecomp")) {
      EXPECT_TRUE(history_of(harness)) << line;
    }
  }
}

// Seconds of work are not waited for.
TEST(Stream, AFlushEndsTheWaitForTheDevice) {
  const std::string caps = VideoHarness::caps("RGBA", 640, 360);
  VideoHarness harness("intrinsicdecompthesis quality=best", caps, caps);
  const auto frame = random_frame(caps, 1);
  GstElement* element = harness.find("intrinsicdecompthesis");
  GstFlowReturn flow = GST_FLOW_OK;
  std::thread streaming([&] { flow = harness.push(frame); });
  g_usleep(200'000);
  gst_harness_push_event(harness.harness(), gst_event_new_flush_start());
  streaming.join();
  if (flow == GST_FLOW_OK) GTEST_SKIP() << "the frame was done before the flush";
  EXPECT_EQ(flow, GST_FLOW_FLUSHING);
  EXPECT_FALSE(find_stat<guint64>(element, "frames")) << "it was waited for";
  gst_harness_push_event(harness.harness(), gst_event_new_flush_stop(TRUE));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  gst_harness_push_event(harness.harness(), gst_event_new_segment(&segment));
  g_object_set(element, "quality", 0, nullptr);
  EXPECT_EQ(harness.process(frame).size(), frame.size());
  EXPECT_TRUE(find_stat<guint64>(element, "frames"));
  EXPECT_EQ(harness.errors(), std::vector<std::string>());
}

}  // namespace inverse::testing
