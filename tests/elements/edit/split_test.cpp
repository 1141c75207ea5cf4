// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicsplit: what each pad carries, and pads that come, go, stay unlinked and block.
#include <gst/check/gsttestclock.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <thread>

#include "tests/elements/element_test.hpp"
#include "tests/elements/layer_of.hpp"
#include "tests/srgb.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {
namespace {

/// A decomposer (and editor) whose layers go by hand into an intrinsicsplit with some of its pads.
class Split : public ::testing::Test {
 protected:
  void SetUp() override {
    GstElement* element = gst_element_factory_make("intrinsicsplit", nullptr);
    sink_ = gst_harness_new_with_element(element, "sink", nullptr);
    gst_object_unref(element);
    gst_element_set_bus(element, bus_);
  }
  void TearDown() override {
    gst_element_set_bus(sink_->element, nullptr);
    for (auto& [name, harness] : pads_) gst_harness_teardown(harness);
    gst_harness_teardown(sink_);
    gst_object_unref(bus_);
  }

  void decompose(int width, int height, const char* line = "intrinsicdecomp") {
    decomposer_ = std::make_unique<VideoHarness>(
        line, caps_ = VideoHarness::caps("RGBA", width, height), kLayers);
  }
  GstElement* element() { return sink_->element; }
  GstHarness* pad(const std::string& name) {
    GstHarness*& harness = pads_[name];
    if (!harness) harness = gst_harness_new_with_element(element(), nullptr, name.c_str());
    return harness;
  }
  void drop(const std::string& name) {
    gst_harness_teardown(pads_[name]);
    pads_.erase(name);
  }
  /// Layers of one frame; kept in `layers_` too.
  GstFlowReturn push(const std::vector<uint8_t>& frame) {
    Buffer buffer = decomposer_->process_buffer(frame);
    const std::string caps = caps_out_of(decomposer_->harness());
    if (caps != caps_sent_) gst_harness_set_src_caps_str(sink_, caps.c_str());
    caps_sent_ = caps;
    layers_.clear();
    for (const GstInverseRole role : {GST_INVERSE_ROLE_INPUT, GST_INVERSE_ROLE_MODEL,
                                      GST_INVERSE_ROLE_INTRINSIC, GST_INVERSE_ROLE_MASK})
      layers_.push_back(layer_of(buffer.get(), role));
    return gst_harness_push(sink_, buffer.release());
  }
  std::vector<uint8_t> pull(const std::string& name) {
    const Buffer buffer(gst_harness_try_pull(pad(name)));
    return buffer ? bytes_of(buffer.get()) : std::vector<uint8_t>{};
  }
  std::vector<std::string> errors() { return texts_of(bus_, GST_MESSAGE_ERROR); }
  std::string caps_of(const std::string& name) { return caps_out_of(pad(name)); }
  /// Another pad, which nothing is linked to.
  GstPad* request(const char* name) { return gst_element_request_pad_simple(element(), name); }
  void give_back(GstPad* pad) {
    gst_element_release_request_pad(element(), pad);
    gst_object_unref(pad);
  }

  GstBus* bus_ = gst_bus_new();
  GstHarness* sink_ = nullptr;
  std::map<std::string, GstHarness*> pads_;
  std::unique_ptr<VideoHarness> decomposer_;
  std::string caps_, caps_sent_;
  std::vector<std::vector<float>> layers_;  // by role, of the last frame
};

}  // namespace

TEST_F(Split, LinearSixteenBitPadsCarryTheNumbersOfTheLayers) {
  decompose(37, 21, "intrinsicdecomp light-color-slope=0");
  g_object_set(element(), "encoding", 0 /* linear */, "reflectance-scale", 0.25f, "shading-scale",
               0.5f, nullptr);
  gst_harness_set_sink_caps_str(pad("reflectance"), "video/x-raw, format=RGBA64_LE");
  gst_harness_set_sink_caps_str(pad("shading"), "video/x-raw, format=GRAY16_LE");
  ASSERT_EQ(push(random_frame(caps_, 3)), GST_FLOW_OK);
  expect_contains(caps_of("shading"), "colorimetry=(string)1:4:1:1");
  const auto reflectance = pull("reflectance"), shading = pull("shading");
  const size_t stride = (37 * 2 + 3) / 4 * 4;  // gray rows are padded
  ASSERT_EQ(reflectance.size(), 37u * 21 * 8);
  ASSERT_EQ(shading.size(), stride * 21);
  const auto& layer = layers_[GST_INVERSE_ROLE_INTRINSIC];
  for (size_t n = 0; n < 37 * 21; ++n) {
    for (size_t c = 0; c < 3; ++c) {
      const int code = reflectance[8 * n + 2 * c] + 256 * reflectance[8 * n + 2 * c + 1];
      ASSERT_NEAR(code, std::min(layer[4 * n + c] * 0.25, 1.0) * 65535, 1.0) << n;
    }
    const size_t at = n / 37 * stride + n % 37 * 2;
    ASSERT_NEAR(shading[at] + 256 * shading[at + 1], std::min(layer[4 * n + 3] * 0.5, 1.0) * 65535,
                1.0)
        << n;
  }
}

TEST_F(Split, ReflectanceTimesShadingInColoredLightIsTheFrame) {
  for (const char* chain :
       {"intrinsicdecomp light-color-slope=0.8", "intrinsicdecomp light-color-slope=-0.8"}) {
    decompose(37, 21, chain);
    constexpr float kScale = 0.25F;
    g_object_set(element(), "encoding", 0 /* linear */, "reflectance-scale", kScale,
                 "shading-scale", kScale, nullptr);
    for (const char* name : {"reflectance", "shading"})
      gst_harness_set_sink_caps_str(pad(name), "video/x-raw, format=RGBA64_LE");
    ASSERT_EQ(push(random_frame(caps_, 3)), GST_FLOW_OK);
    const auto reflectance = pull("reflectance"), shading = pull("shading");
    ASSERT_EQ(shading.size(), 37U * 21 * 8);
    const auto value = [&](const std::vector<uint8_t>& of, size_t n, size_t c) {
      return float(of[8 * n + 2 * c] + 256 * of[8 * n + 2 * c + 1]) / 65535 / kScale;
    };
    const auto& input = layers_[GST_INVERSE_ROLE_INPUT];
    float reddest = 0, bluest = 0;
    for (size_t n = 0; n < 37 * 21; ++n) {
      const float tint = std::log((value(shading, n, 0) + 1e-3F) / (value(shading, n, 2) + 1e-3F));
      reddest = std::max(reddest, tint), bluest = std::min(bluest, tint);
      for (size_t c = 0; c < 3; ++c) {
        const float r = value(reflectance, n, c), s = value(shading, n, c);
        if (std::max(r, s) < 0.999F / kScale) {
          ASSERT_NEAR(r * s, input[4 * n + c], 1e-4 * (1 + r + s)) << chain << " " << n;
        }
      }
    }
    EXPECT_GT(reddest - bluest, 0.1F) << chain;
  }
}

TEST_F(Split, EightBitPadsFollowTheSrgbCurve) {
  decompose(20, 12, "intrinsicdecomp light-color-slope=0");
  gst_harness_set_sink_caps_str(pad("reflectance"), "video/x-raw, format=RGBA");
  gst_harness_set_sink_caps_str(pad("input"), "video/x-raw, format=RGBA");
  gst_harness_set_sink_caps_str(pad("shading"), "video/x-raw");  // color by choice
  const auto frame = random_frame(caps_, 3);
  ASSERT_EQ(push(frame), GST_FLOW_OK);
  expect_contains(caps_of("shading"), "format=(string)RGBA");
  expect_contains(caps_of("reflectance"), "colorimetry=(string)sRGB");
  EXPECT_LE(largest_difference(pull("input"), frame), 1);
  const auto reflectance = pull("reflectance"), shading = pull("shading");
  const auto& layer = layers_[GST_INVERSE_ROLE_INTRINSIC];
  for (size_t n = 0; n < 20 * 12; ++n) {
    for (size_t c = 0; c < 3; ++c)
      ASSERT_NEAR(reflectance[4 * n + c], srgb_code(std::min(layer[4 * n + c], 1.0f)) * 255, 0.51);
    ASSERT_NEAR(shading[4 * n], srgb_code(std::min(layer[4 * n + 3] * 0.5f, 1.0f)) * 255, 0.51);
  }
}

TEST_F(Split, EverySupportedFormatComesOutOfEveryPad) {
  decompose(15, 10, "intrinsicdecomp ! intrinsicrecolor key=0xffc83c28 write-mask=true");
  for (const char* format : {"RGBA", "BGRA", "RGBx", "BGRx", "RGB", "BGR", "NV12", "I420", "YUY2",
                             "UYVY", "GRAY8", "GRAY16_LE", "P010_10LE", "I420_10LE", "RGBA64_LE"}) {
    const std::string caps = VideoHarness::caps(format, 15, 10);
    for (const char* name : {"reflectance", "shading", "mask", "input"})
      gst_harness_set_sink_caps_str(pad(name), caps.c_str());
    const auto frame = random_frame(caps_, 1);
    ASSERT_EQ(push(frame), GST_FLOW_OK) << format;
    for (const char* name : {"reflectance", "shading", "mask", "input"})
      EXPECT_EQ(pull(name).size(), random_frame(caps, 0).size()) << format << " " << name;
    for (const char* name : {"reflectance", "shading", "mask", "input"}) drop(name);
  }
  EXPECT_TRUE(errors().empty());
}

TEST_F(Split, MaskPadSendsTheSelection) {
  decompose(16, 8,
            "intrinsicdecomp ! intrinsicrecolor key=0xffc83c28 tolerance=1.2 write-mask=true");
  gst_harness_set_sink_caps_str(pad("mask"), "video/x-raw, format=GRAY8");
  ASSERT_EQ(push(random_frame(caps_, 3)), GST_FLOW_OK);
  const auto mask = pull("mask");
  const auto& layer = layers_[GST_INVERSE_ROLE_MASK];
  ASSERT_EQ(mask.size(), 16u * 8);
  ASSERT_EQ(layer.size(), 16u * 8 * 4);
  float smallest = 1, largest = 0;
  for (size_t n = 0; n < mask.size(); ++n) {
    ASSERT_NEAR(mask[n], srgb_code(layer[4 * n]) * 255, 0.51);
    smallest = std::min(smallest, layer[4 * n]);
    update_max(largest, layer[4 * n]);
  }
  EXPECT_LT(smallest, 0.1f);
  EXPECT_GT(largest, 0.9f);
}

TEST_F(Split, AMissingLayerIsOneErrorWithItsRemedy) {
  decompose(16, 8);
  pad("mask");
  EXPECT_EQ(push(random_frame(caps_, 3)), GST_FLOW_ERROR);
  expect_one(errors(), "write-mask=true");
}

TEST_F(Split, APadThatNothingSuitsIsOneErrorThatNamesIt) {
  decompose(16, 8);
  gst_harness_set_sink_caps_str(pad("shading"), "video/x-raw, format=UYVP");
  pad("reflectance");
  EXPECT_NE(push(random_frame(caps_, 3)), GST_FLOW_OK);
  expect_one(errors(), "pad shading of intrinsicsplit");
}

TEST_F(Split, ALatePadReceivesAllThatComesBeforeFrames) {
  decompose(16, 8);
  pad("shading");
  ASSERT_EQ(push(random_frame(caps_, 1)), GST_FLOW_OK);
  GstHarness* late = pad("reflectance");
  ASSERT_EQ(push(random_frame(caps_, 2)), GST_FLOW_OK);
  EXPECT_EQ(pull("reflectance").size(), 16U * 8 * 4);
  std::vector<GstEventType> types;
  while (GstEvent* event = gst_harness_try_pull_event(late)) {
    types.push_back(GST_EVENT_TYPE(event));
    gst_event_unref(event);
  }
  EXPECT_EQ(types, (std::vector{GST_EVENT_STREAM_START, GST_EVENT_CAPS, GST_EVENT_SEGMENT,
                                GST_EVENT_CUSTOM_DOWNSTREAM_STICKY}));  // how pictures are made
  const auto first = pull("shading"), second = pull("shading");
  EXPECT_EQ(first.size(), 4U * 16 * 8);
  EXPECT_EQ(second.size(), first.size());
  EXPECT_NE(first, second);
}

TEST_F(Split, PadsAreStreamsOfTheirOwn) {
  decompose(16, 8);
  ASSERT_EQ((pad("shading"), pad("reflectance"), push(random_frame(caps_, 1))), GST_FLOW_OK);
  gchar* a = gst_pad_get_stream_id(pad("shading")->sinkpad);
  gchar* b = gst_pad_get_stream_id(pad("reflectance")->sinkpad);
  EXPECT_STRNE(a, b);
  g_free(a);
  g_free(b);
}

TEST_F(Split, APadIsGivenBackWhileThereIsFlow) {
  decompose(16, 8);
  pad("shading");
  pad("reflectance");
  // Frames flow in one thread while pads come and go in this one.
  std::atomic<bool> stop{false};
  std::atomic<int> bad{0}, good{0};
  ASSERT_EQ(push(random_frame(caps_, 1)), GST_FLOW_OK);
  const auto frame = random_frame(caps_, 2);
  std::thread flow([&] {
    while (!stop) ++(push(frame) == GST_FLOW_OK ? good : bad);
  });
  for (int i = 0; i < 30; ++i) {
    GstPad* mine = request("input");
    ASSERT_NE(mine, nullptr);
    for (const int before = good + bad; good + bad < before + 2;)
      g_usleep(100);  // a frame meets it
    give_back(mine);
  }
  stop = true;
  flow.join();
  EXPECT_EQ(bad, 0);
  EXPECT_GT(good, 0);
  drop("reflectance");
  EXPECT_EQ(push(frame), GST_FLOW_OK);
  EXPECT_TRUE(errors().empty());
}

TEST_F(Split, EachLayerHasOnePadAndUnknownLayersNone) {
  GstPad* pad = request("shading");
  ASSERT_NE(pad, nullptr);
  for (const char* unknown : {"normals", "indirect_16", "indirect_x", "indirect_"})
    EXPECT_EQ(request(unknown), nullptr) << unknown;
  give_back(pad);
  pad = request("shading");
  ASSERT_NE(pad, nullptr) << "a pad that was given back can be asked for again";
  give_back(pad);
}

TEST_F(Split, UnlinkedPadsDoNotStopTheOthers) {
  decompose(16, 8);
  GstPad* loose = request("input");
  EXPECT_EQ(push(random_frame(caps_, 1)), GST_FLOW_NOT_LINKED) << "nobody listens at all";
  pad("shading");
  EXPECT_EQ(push(random_frame(caps_, 2)), GST_FLOW_OK);
  EXPECT_EQ(pull("shading").size(), 4U * 16 * 8);
  give_back(loose);
}

TEST_F(Split, EosFlushesAndCapsChangesReachEveryPad) {
  decompose(16, 8);
  pad("shading");
  pad("reflectance");
  for (int i = 0; i < 6; ++i) {
    const std::string caps = VideoHarness::caps("RGBA", 16 + 4 * i, 8 + i);
    decomposer_->set_src_caps(caps);
    ASSERT_EQ(push(random_frame(caps, 1)), GST_FLOW_OK);
    expect_contains(caps_of("shading"), "width=(int)" + std::to_string(16 + 4 * i));
    const auto pixels = static_cast<size_t>((16 + 4 * i) * (8 + i));
    EXPECT_EQ(pull("reflectance").size(), pixels * 4);
    EXPECT_EQ(pull("shading").size(), 4 * pixels);
    flush(sink_);
  }
  gst_harness_push_event(sink_, gst_event_new_eos());
  for (const char* name : {"shading", "reflectance"}) {
    GstEventType last = GST_EVENT_UNKNOWN;
    int flushes = 0;
    while (GstEvent* event = gst_harness_try_pull_event(pad(name))) {
      last = GST_EVENT_TYPE(event);
      flushes += last == GST_EVENT_FLUSH_STOP;
      gst_event_unref(event);
    }
    EXPECT_EQ(last, GST_EVENT_EOS) << name;
    EXPECT_EQ(flushes, 6) << name;
  }
  EXPECT_TRUE(errors().empty());
}

TEST_F(Split, TimesAndFlagsTravelWithTheFrame) {
  decompose(16, 8);
  pad("shading");
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(push(random_frame(caps_, 1)), GST_FLOW_OK);
    const Buffer buffer(gst_harness_pull(pad("shading")));
    EXPECT_EQ(GST_BUFFER_PTS(buffer.get()), i * GST_SECOND / 25);
    EXPECT_EQ(GST_BUFFER_DURATION(buffer.get()), GST_SECOND / 25);
    EXPECT_EQ(gst_buffer_get_inverse_layers_meta(buffer.get()), nullptr);
  }
}

TEST(SplitPipelines, LayersGoToSinksOfTheirOwn) {
  const auto result = run_line(
      "videotestsrc num-buffers=8 ! video/x-raw,width=64,height=48 ! intrinsicdecomp ! "
      "intrinsicrecolor key=0xffc83c28 write-mask=true ! intrinsicsplit name=s "
      "s.reflectance ! queue ! videoconvert ! fakesink "
      "s.mask ! queue ! fakesink "
      "s.shading ! queue ! video/x-raw,format=GRAY16_LE ! appsink name=out");
  EXPECT_TRUE(result.eos) << result.first_error();
  EXPECT_EQ(result.frames.size(), 8u);
  EXPECT_EQ(GST_VIDEO_INFO_FORMAT(&result.info), GST_VIDEO_FORMAT_GRAY16_LE);
}

/// The system clock, which tests turn on by hand.
class TurnedClock {
 public:
  TurnedClock() : clock_(GST_TEST_CLOCK(gst_test_clock_new())) {
    gst_system_clock_set_default(GST_CLOCK(clock_));
  }
  TurnedClock(const TurnedClock&) = delete;
  TurnedClock& operator=(const TurnedClock&) = delete;
  ~TurnedClock() {
    gst_system_clock_set_default(nullptr);
    gst_object_unref(clock_);
  }
  /// Waits until somebody asks to be called, and calls what is due then; fails the test after a
  /// minute.
  void turn() {
    for (int i = 0; i < 60'000; ++i, g_usleep(1000))
      if (gst_test_clock_peek_next_pending_id(clock_, nullptr)) {
        gst_test_clock_crank(clock_);
        return;
      }
    ADD_FAILURE() << "nobody asks the clock";
  }

 private:
  GstTestClock* clock_;
};

/// intrinsicsplit in a pipeline whose first pad is blocked.
class BlockedPads : public ::testing::Test {
 protected:
  void start(const std::string& branches, GstState state = GST_STATE_PLAYING) {
    GError* error = nullptr;
    pipeline_ = gst_parse_launch(
        ("videotestsrc num-buffers=3 ! video/x-raw,width=64,height=48 ! intrinsicdecomp ! "
         "intrinsicsplit name=s " +
         branches)
            .c_str(),
        &error);
    ASSERT_EQ(error, nullptr) << error->message;
    bus_ = gst_element_get_bus(pipeline_);
    gst_element_set_state(pipeline_, state);
  }
  void TearDown() override {
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    gst_object_unref(bus_);
    gst_object_unref(pipeline_);
  }
  std::vector<std::string> warnings() { return texts_of(bus_, GST_MESSAGE_WARNING); }
  /// Turns the clock until there is a warning; fails the test after a minute.
  std::vector<std::string> awaited_warnings() {
    for (const gint64 end = g_get_monotonic_time() + 60 * G_USEC_PER_SEC;
         g_get_monotonic_time() < end; g_usleep(1000)) {
      clock_.turn();
      if (auto found = warnings(); !found.empty()) return found;
    }
    return {};
  }

  TurnedClock clock_;
  GstElement* pipeline_ = nullptr;
  GstBus* bus_ = nullptr;
};

TEST_F(BlockedPads, AreWarnedOfOnceByNameWithTheRemedy) {
  start("s.reflectance ! videoconvert ! fakesink name=first s.shading ! fakesink");
  expect_one(awaited_warnings(), "pad reflectance of s (intrinsicsplit) is blocked",
             "first (fakesink) waits", "pad shading", "put a queue behind every pad");
  for (int i = 0; i < 3; ++i) clock_.turn();
  EXPECT_TRUE(warnings().empty());
}

TEST_F(BlockedPads, AreNamedBehindBinsAndATee) {
  start(
      "s.reflectance ! bin.( tee name=t ! fakesink name=first t. ! queue ! fakesink ) "
      "s.shading ! queue ! fakesink s.input ! queue ! fakesink");
  expect_one(awaited_warnings(), "pad reflectance of s", "first (fakesink) waits",
             "pad shading and input");
}

/// oggmux holds each pad's first frame until all have one. Muxers made of GstAggregator, as
/// matroskamux since GStreamer 1.26, queue it, and nothing is blocked.
TEST_F(BlockedPads, MayWaitInAMuxer) {
  start(
      "s.reflectance ! videoconvert ! theoraenc ! oggmux name=mux ! fakesink "
      "s.shading ! videoconvert ! theoraenc ! mux.");
  expect_one(awaited_warnings(), "pad reflectance of s", "mux (oggmux) waits", "pad shading");
}

TEST_F(BlockedPads, ASlowElementIsNone) {
  struct Gate {
    std::atomic<bool> entered{false}, open{false};
  } gate;
  start("s.reflectance ! identity name=slow ! queue ! fakesink s.shading ! queue ! fakesink",
        GST_STATE_READY);
  watch_buffers(find_element(pipeline_, "slow"), "sink", [&gate](GstBuffer*) {
    gate.entered = true;
    while (!gate.open) g_usleep(1000);
  });
  gst_element_set_state(pipeline_, GST_STATE_PLAYING);
  while (!gate.entered) g_usleep(1000);
  for (int i = 0; i < 3; ++i) clock_.turn();
  EXPECT_TRUE(warnings().empty());
  gate.open = true;
  EXPECT_EQ(gst_element_get_state(pipeline_, nullptr, nullptr, GST_CLOCK_TIME_NONE),
            GST_STATE_CHANGE_SUCCESS);
}

/// The other sink asks for no frame, so the pipeline is paused as it should be.
TEST_F(BlockedPads, APausedPipelineIsNone) {
  start("s.reflectance ! fakesink s.shading ! fakesink async=false", GST_STATE_PAUSED);
  ASSERT_EQ(gst_element_get_state(pipeline_, nullptr, nullptr, GST_CLOCK_TIME_NONE),
            GST_STATE_CHANGE_SUCCESS);
  for (int i = 0; i < 3; ++i) clock_.turn();
  EXPECT_TRUE(warnings().empty());
}

TEST(SplitPipelines, OneFrameOfLatencyIsAdded) {
  const std::string caps = VideoHarness::caps("RGBA", 16, 8);
  VideoHarness harness("intrinsicdecomp ! intrinsicsplit name=s s.shading ! identity", caps);
  gst_harness_set_upstream_latency(harness.harness(), 5 * GST_MSECOND);
  harness.process(random_frame(caps, 1));
  EXPECT_EQ(gst_harness_query_latency(harness.harness()), 45 * GST_MSECOND);
}

}  // namespace inverse::testing
