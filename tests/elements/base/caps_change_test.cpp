// SPDX-License-Identifier: LGPL-2.1-or-later
// Lines of elements with several pads, whose sources change their caps, flush, ask whether frames
// are drained and pause for a while, in orders by chance: each line ends in a state in which frames
// of the last caps go through.
#include <gst/app/gstappsrc.h>

#include <algorithm>
#include <atomic>
#include <random>

#include "tests/elements/element_test.hpp"
#include "tests/has_element.hpp"

namespace inverse::testing {
namespace {

constexpr GstClockTime kFrame = 40 * GST_MSECOND;

/// What a source may send: caps of pictures that come together have one size.
const std::vector<std::string> kColors{
    "format=RGBA,width=32,height=24",
    "format=I420,width=48,height=32",
    "format=RGBA,width=32,height=24,pixel-aspect-ratio=4/3",
    "format=NV12,width=33,height=17,colorimetry=bt709",
    "format=YUY2,width=48,height=32,colorimetry=bt601",
    "format=RGBA64_LE,width=16,height=40",
    "format=GRAY8,width=48,height=32",
    "format=I420_10LE,width=64,height=24,colorimetry=bt2020",
};
const std::vector<std::string> kDepths{
    "format=GRAY16_LE,width=32,height=24", "format=GRAY16_LE,width=48,height=32",
    "format=GRAY16_LE,width=32,height=24", "format=GRAY16_LE,width=16,height=12",
    "format=GRAY16_LE,width=48,height=32", "format=GRAY16_LE,width=16,height=40",
    "format=GRAY16_LE,width=48,height=32", "format=GRAY16_LE,width=64,height=24",
};
const std::vector<std::string> kRates{"25/1", "30000/1001", "0/1"};

struct Source {
  const char* name;
  const std::vector<std::string>* caps;
};

struct Line {
  const char* name;
  std::string text;  ///< with appsrc of the sources' names, and fakesinks out0, out1 …
  std::vector<Source> sources;
  guint64 frames = 4;  ///< of the last eight that each fakesink gets, at least
};

class Player {
 public:
  Player(const Line& line, unsigned seed) : line_(line), random_(seed) {
    GError* error = nullptr;
    pipeline_ = gst_parse_launch(line.text.c_str(), &error);
    EXPECT_EQ(error, nullptr) << error->message;
    for (const Source& source : line.sources) {
      GstElement* element = gst_bin_get_by_name(GST_BIN(pipeline_), source.name);
      g_object_set(element, "format", GST_FORMAT_TIME, "max-buffers", guint64{4}, "block", FALSE,
                   nullptr);
      sources_.push_back(element);
    }
    drains_ = std::vector<std::atomic<bool>>(sources_.size());
    for (size_t s = 0; s < sources_.size(); ++s) {
      GstPad* pad = gst_element_get_static_pad(sources_[s], "src");
      gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, drain, &drains_[s], nullptr);
      gst_object_unref(pad);
    }
    for (int i = 0;; ++i) {
      GstElement* sink =
          gst_bin_get_by_name(GST_BIN(pipeline_), ("out" + std::to_string(i)).c_str());
      if (!sink) break;
      g_object_set(sink, "sync", FALSE, "async", FALSE, nullptr);
      sinks_.push_back(sink);
    }
    gst_element_set_state(pipeline_, GST_STATE_PLAYING);
  }
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;
  ~Player() {
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    for (GstElement* element : sources_) gst_object_unref(element);
    for (GstElement* element : sinks_) gst_object_unref(element);
    gst_object_unref(pipeline_);
  }

  /// Some frames of all sources with other caps, which come to each source in its own time.
  void play_part() {
    choice_ = pick(line_.sources[0].caps->size());
    rate_ = pick(kRates.size());
    const size_t frames = 1 + pick(4);
    std::vector<size_t> order;
    for (size_t s = 0; s < sources_.size(); ++s) order.insert(order.end(), frames, s);
    std::ranges::shuffle(order, random_);
    std::vector<size_t> sent(sources_.size());
    for (const size_t s : order) {
      push(s, time_ + sent[s]++ * kFrame);
      if (pick(6) == 0) drains_[s] = true;
      if (pick(6) == 0) g_usleep(static_cast<gulong>(pick(3000)));
    }
    time_ += frames * kFrame;
    if (pick(3) == 0) flush();
  }

  /// Frames of the last caps go through, and the end.
  void finish() {
    flush();
    std::vector<guint64> before;
    for (GstElement* sink : sinks_) before.push_back(rendered(sink));
    for (size_t n = 0; n < 8; ++n, time_ += kFrame)
      for (size_t s = 0; s < sources_.size(); ++s) push(s, time_);
    for (GstElement* source : sources_) gst_app_src_end_of_stream(GST_APP_SRC(source));
    GstBus* bus = gst_element_get_bus(pipeline_);
    GstMessage* message = gst_bus_timed_pop_filtered(
        bus, 60 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
    gst_object_unref(bus);
    ASSERT_NE(message, nullptr) << "it hangs";
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
      GError* error = nullptr;
      gst_message_parse_error(message, &error, nullptr);
      ADD_FAILURE() << error->message;
      g_error_free(error);
    }
    gst_message_unref(message);
    for (size_t i = 0; i < sinks_.size(); ++i)
      EXPECT_GE(rendered(sinks_[i]), before[i] + line_.frames) << "of out" << i;
  }

 private:
  size_t pick(size_t count) { return std::uniform_int_distribution<size_t>(0, count - 1)(random_); }

  void push(size_t s, GstClockTime time) {
    const std::string caps =
        "video/x-raw," + (*line_.sources[s].caps)[choice_] + ",framerate=" + kRates[rate_];
    const auto bytes = random_frame(caps, static_cast<unsigned>(time / kFrame));
    GstBuffer* buffer = gst_buffer_new_memdup(bytes.data(), bytes.size());
    GST_BUFFER_PTS(buffer) = time;
    GST_BUFFER_DURATION(buffer) = kFrame;
    GstCaps* of_caps = gst_caps_from_string(caps.c_str());
    GstSample* sample = gst_sample_new(buffer, of_caps, nullptr, nullptr);
    gst_app_src_push_sample(GST_APP_SRC(sources_[s]), sample);
    gst_sample_unref(sample);
    gst_caps_unref(of_caps);
    gst_buffer_unref(buffer);
  }

  /// Asks whether frames are drained, in the thread of a source, as one does before other caps.
  static GstPadProbeReturn drain(GstPad* pad, GstPadProbeInfo*, gpointer wanted) {
    if (!static_cast<std::atomic<bool>*>(wanted)->exchange(false)) return GST_PAD_PROBE_OK;
    GstQuery* query = gst_query_new_drain();
    gst_pad_peer_query(pad, query);
    gst_query_unref(query);
    return GST_PAD_PROBE_OK;
  }

  void flush() {
    for (GstElement* source : sources_) gst_element_send_event(source, gst_event_new_flush_start());
    for (GstElement* source : sources_)
      gst_element_send_event(source, gst_event_new_flush_stop(TRUE));
    time_ = 0;
  }

  static guint64 rendered(GstElement* sink) {
    GstStructure* stats = nullptr;
    g_object_get(sink, "stats", &stats, nullptr);
    guint64 count = 0;
    gst_structure_get_uint64(stats, "rendered", &count);
    gst_structure_free(stats);
    return count;
  }

  const Line& line_;
  std::mt19937 random_;
  GstElement* pipeline_ = nullptr;
  std::vector<GstElement*> sources_, sinks_;
  std::vector<std::atomic<bool>> drains_;  // before the next frame of a source
  size_t choice_ = 0, rate_ = 0;
  GstClockTime time_ = 0;
};

std::vector<Line> lines() {
  gst_init(nullptr, nullptr);
  const std::string light = "appsrc name=a ! intrinsicdecomp adaptive=false ! ";
  const std::vector<Source> one{{"a", &kColors}}, two{{"a", &kColors}, {"b", &kColors}};
  std::vector<Line> all{
      {"split",
       light + "intrinsicsplit name=s s.reflectance ! queue ! fakesink name=out0 "
               "s.shading ! queue ! fakesink name=out1 s.input ! queue ! fakesink name=out2",
       one},
      {"merge",
       light + "tee name=t t. ! queue ! intrinsicsplit name=s s.shading ! videoconvert ! m.shading "
               "t. ! queue ! intrinsicmerge name=m ! intrinsiccompose ! fakesink name=out0",
       one},
      {"edit", light + "intrinsicedit effect=identity ! intrinsiccompose ! fakesink name=out0",
       one},
      {"mask",
       light + "intrinsicmerge name=m ! intrinsiccompose ! fakesink name=out0 appsrc name=b ! "
               "queue ! m.mask",
       two},
      {"depth",
       "rgbdmerge name=m ! intrinsicdecomp adaptive=false ! intrinsiccompose ! fakesink name=out0 "
       "appsrc name=a ! m.sink appsrc name=b ! m.depth",
       {{"a", &kColors}, {"b", &kDepths}}},
      {"global",
       "appsrc name=a ! globalintrinsic ! intrinsicsplit name=s s.direct ! queue ! fakesink "
       "name=out0 s.indirect_0 ! queue ! fakesink name=out1",
       one},
  };
  if (has_element("intrinsictexture"))
    all.push_back({"texture",
                   light + "intrinsictexture name=x corners=\"2,2 12,2 12,12 2,12\" ! "
                           "intrinsiccompose ! fakesink name=out0 appsrc name=b ! x.texture",
                   two});
  if (has_element("lightstagesync"))
    all.push_back({"cameras",
                   "lightstagesync name=s program=static s.src_0 ! fakesink name=out0 s.src_1 ! "
                   "fakesink name=out1 appsrc name=a ! s.sink_0 appsrc name=b ! s.sink_1",
                   two, 0});  // without the marker of a light program no frame has a label
  return all;
}

class CapsChange : public ::testing::TestWithParam<Line> {};

TEST_P(CapsChange, FramesOfTheLastCapsGoThrough) {
  constexpr unsigned kRuns = 4, kParts = 8;
  for (unsigned seed = 0; seed < kRuns && !HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Player player(GetParam(), seed);
    for (unsigned part = 0; part < kParts; ++part) player.play_part();
    player.finish();
  }
}

INSTANTIATE_TEST_SUITE_P(All, CapsChange, ::testing::ValuesIn(lines()),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace inverse::testing
