// SPDX-License-Identifier: LGPL-2.1-or-later
#include "element_test.hpp"

#include <execinfo.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <numeric>

#include "own_process.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

/// "factory: text" of an error or a warning.
std::string complaint_of(GstMessage* message) {
  std::string factory = "application";
  if (GST_IS_ELEMENT(GST_MESSAGE_SRC(message)))
    if (GstElementFactory* made_by = gst_element_get_factory(GST_ELEMENT(GST_MESSAGE_SRC(message))))
      factory = GST_OBJECT_NAME(made_by);
  return factory + ": " + text_of(message);
}

/// The pipeline of a line; null if there is none, as `result` says then.
GstElement* parsed(const std::string& line, LineResult& result) {
  GError* error = nullptr;
  GstElement* pipeline = gst_parse_launch(line.c_str(), &error);
  if (!error) return pipeline;
  result.errors.push_back(std::string("parse: ") + error->message);
  g_error_free(error);
  if (pipeline) gst_object_unref(pipeline);
  return nullptr;
}

/// Runs a pipeline to its end.
void play(GstElement* pipeline, const std::string& line, unsigned seconds, LineResult& result) {
  gst_video_info_init(&result.info);
  GstElement* sink = find_element(pipeline, "out");
  gulong handler = 0;
  if (sink) {
    g_object_set(sink, "sync", FALSE, "emit-signals", TRUE, nullptr);
    handler = g_signal_connect(sink, "new-sample",
                               G_CALLBACK(+[](GstAppSink* app, LineResult* kept) -> GstFlowReturn {
                                 GstSample* sample = gst_app_sink_pull_sample(app);
                                 kept->frames.push_back(bytes_of(gst_sample_get_buffer(sample)));
                                 gst_video_info_from_caps(&kept->info, gst_sample_get_caps(sample));
                                 gst_sample_unref(sample);
                                 return GST_FLOW_OK;
                               }),
                               &result);
  }
  GstBus* bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  const gint64 deadline = g_get_monotonic_time() + seconds * G_USEC_PER_SEC;
  while (!result.eos && result.errors.empty()) {
    const gint64 left = deadline - g_get_monotonic_time();
    GstMessage* message = gst_bus_timed_pop_filtered(
        bus, left > 0 ? static_cast<GstClockTime>(left) * 1000 : 0,
        static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR | GST_MESSAGE_WARNING |
                                    GST_MESSAGE_ELEMENT));
    if (!message) {
      ADD_FAILURE() << "neither ended nor complained within " << seconds << " s: " << line;
      break;
    }
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS)
      result.eos = true;
    else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR)
      result.errors.push_back(complaint_of(message));
    else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ELEMENT)
      result.messages.push_back(gst_structure_get_name(gst_message_get_structure(message)));
    else
      result.warnings.push_back(complaint_of(message));
    gst_message_unref(message);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  while (GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR)) {
    result.errors.push_back(complaint_of(message));
    gst_message_unref(message);
  }
  gst_object_unref(bus);
  if (handler) g_signal_handler_disconnect(sink, handler);
}

}  // namespace

LineResult run_line(const std::string& line, unsigned seconds,
                    const std::function<void(GstElement* pipeline)>& prepare) {
  LineResult result;
  GstElement* pipeline = parsed(line, result);
  if (!pipeline) return result;
  if (prepare) prepare(pipeline);
  play(pipeline, line, seconds, result);
  gst_object_unref(pipeline);
  return result;
}

std::vector<LineResult> run_line_again(const std::string& line, size_t times,
                                       const std::function<void()>& between) {
  std::vector<LineResult> results(times);
  GstElement* pipeline = parsed(line, results.front());
  if (!pipeline) return results;
  for (size_t i = 0; i < times; ++i) {
    if (i > 0 && between) between();
    play(pipeline, line, 60, results[i]);
  }
  gst_object_unref(pipeline);
  return results;
}

void flush(GstHarness* harness) {
  gst_harness_push_event(harness, gst_event_new_flush_start());
  gst_harness_push_event(harness, gst_event_new_flush_stop(TRUE));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  gst_harness_push_event(harness, gst_event_new_segment(&segment));
}

bool has_pixels(GstBuffer* buffer) {
  GstMapInfo map;
  if (!gst_buffer_map(buffer, &map, GST_MAP_READ)) return false;
  gst_buffer_unmap(buffer, &map);
  return true;
}

std::string caps_out_of(GstHarness* harness) {
  GstCaps* caps = gst_pad_get_current_caps(harness->sinkpad);
  if (!caps) return "";
  gchar* text = gst_caps_to_string(caps);
  std::string result = text;
  g_free(text);
  gst_caps_unref(caps);
  return result;
}

VideoHarness::VideoHarness(const std::string& line, const std::string& src_caps,
                           const std::string& sink_caps)
    : harness_(gst_harness_new_parse(line.c_str())), bus_(gst_bus_new()) {
  gst_element_set_bus(harness_->element, bus_);
  if (!sink_caps.empty()) gst_harness_set_sink_caps_str(harness_, sink_caps.c_str());
  gst_harness_set_src_caps_str(harness_, src_caps.c_str());
}

VideoHarness::~VideoHarness() {
  gst_element_set_bus(harness_->element, nullptr);
  gst_harness_teardown(harness_);
  gst_object_unref(bus_);
}

std::string VideoHarness::caps(const std::string& format, int width, int height,
                               const std::string& more) {
  return "video/x-raw, format=" + format + ", width=" + std::to_string(width) +
         ", height=" + std::to_string(height) + ", framerate=25/1" +
         (more.empty() ? "" : ", " + more);
}

void VideoHarness::set_src_caps(const std::string& caps) {
  gst_harness_set_src_caps_str(harness_, caps.c_str());
}

GstFlowReturn VideoHarness::push(const std::vector<uint8_t>& bytes) {
  GstBuffer* buffer = gst_buffer_new_memdup(bytes.data(), bytes.size());
  GST_BUFFER_PTS(buffer) = time_;
  GST_BUFFER_DURATION(buffer) = GST_SECOND / 25;
  time_ += GST_SECOND / 25;
  return gst_harness_push(harness_, buffer);
}

std::vector<uint8_t> VideoHarness::pull() {
  const Buffer buffer(gst_harness_pull(harness_));  // a minute at most
  return buffer ? bytes_of(buffer.get()) : std::vector<uint8_t>{};
}

std::vector<uint8_t> VideoHarness::process(const std::vector<uint8_t>& bytes) {
  return push(bytes) == GST_FLOW_OK ? pull() : std::vector<uint8_t>{};
}

std::vector<uint8_t> VideoHarness::process(const std::vector<uint8_t>& bytes, int times) {
  std::vector<uint8_t> out;
  for (int i = 0; i < times; ++i) {
    out = process(bytes);
    if (!out.empty()) continue;
    ADD_FAILURE() << "nothing comes out of frame " << i;
    break;
  }
  return out;
}

void VideoHarness::push_after_gap(const std::vector<uint8_t>& bytes, GstClockTime time) {
  GstBuffer* buffer = gst_buffer_new_memdup(bytes.data(), bytes.size());
  GST_BUFFER_PTS(buffer) = time;
  GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_DISCONT);
  EXPECT_EQ(gst_harness_push(harness_, buffer), GST_FLOW_OK);
  const Buffer out(gst_harness_pull(harness_));
}

Buffer VideoHarness::process_buffer(const std::vector<uint8_t>& bytes) {
  EXPECT_EQ(push(bytes), GST_FLOW_OK);
  return Buffer(gst_harness_pull(harness_));
}

std::vector<std::string> VideoHarness::texts(GstMessageType type) {
  std::vector<std::string> texts;
  while (GstMessage* message = gst_bus_pop_filtered(bus_, type)) {
    texts.push_back(complaint_of(message));
    gst_message_unref(message);
  }
  return texts;
}

GstElement* VideoHarness::find(const std::string& factory) {
  GstElement* found = gst_harness_find_element(harness_, factory.c_str());
  if (found) gst_object_unref(found);
  return found;
}

GstVideoInfo info_of(const std::string& text) {
  GstCaps* caps = gst_caps_from_string(text.c_str());
  GstVideoInfo info;
  gst_video_info_init(&info);
  EXPECT_TRUE(gst_video_info_from_caps(&info, caps)) << text;
  gst_caps_unref(caps);
  return info;
}

std::vector<uint8_t> random_frame(const std::string& caps, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<uint8_t> bytes(info_of(caps).size);
  std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<uint8_t>(random()); });
  return bytes;
}

std::vector<uint8_t> flat_frame(const std::string& caps, uint8_t value) {
  return std::vector<uint8_t>(info_of(caps).size, value);
}

std::vector<uint8_t> visible(const std::string& caps, const std::vector<uint8_t>& frame) {
  return visible(info_of(caps), frame);
}

std::vector<uint8_t> visible(const GstVideoInfo& info, const std::vector<uint8_t>& frame) {
  std::vector<uint8_t> bytes;
  for (guint plane = 0; plane < GST_VIDEO_INFO_N_PLANES(&info) && frame.size() >= info.size;
       ++plane) {
    guint component = 0;
    while (GST_VIDEO_INFO_COMP_PLANE(&info, component) != plane) ++component;
    const size_t row_bytes = static_cast<size_t>(GST_VIDEO_INFO_COMP_WIDTH(&info, component)) *
                             static_cast<size_t>(GST_VIDEO_INFO_COMP_PSTRIDE(&info, component));
    for (gint row = 0; row < GST_VIDEO_INFO_COMP_HEIGHT(&info, component); ++row) {
      const auto start =
          frame.begin() + static_cast<ptrdiff_t>(info.offset[plane]) + row * info.stride[plane];
      bytes.insert(bytes.end(), start, start + static_cast<ptrdiff_t>(row_bytes));
    }
  }
  return bytes;
}

int largest_difference(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
  if (a.size() != b.size()) return 256;
  return std::transform_reduce(
      a.begin(), a.end(), b.begin(), 0, [](int x, int y) { return std::max(x, y); },
      [](uint8_t x, uint8_t y) { return std::abs(x - y); });
}

namespace {

/// Keeps the plugin's device open on request.
class DeviceHolder : public ::testing::Environment {
 public:
  static DeviceHolder& get() {
    static auto* const holder =
        new DeviceHolder;  // GoogleTest's own, once it is among its environments
    return *holder;
  }
  void SetUp() override {
    element_ = gst_element_factory_make("intrinsicdecomp", nullptr);
    ASSERT_NE(element_, nullptr) << "the plugin was not found: GST_PLUGIN_PATH";
    hold(true);
  }
  void TearDown() override {
    if (!element_) return;
    hold(false);
    gst_object_unref(element_);
  }
  void hold(bool open) {
    gst_element_set_state(element_, open ? GST_STATE_PAUSED : GST_STATE_NULL);
  }

 private:
  GstElement* element_ = nullptr;
};

}  // namespace

NewDevice::NewDevice() { DeviceHolder::get().hold(false); }

NewDevice::~NewDevice() { DeviceHolder::get().hold(true); }

std::vector<Structure> element_messages(GstBus* bus, const std::string& name) {
  std::vector<Structure> found;
  while (GstMessage* message = gst_bus_pop_filtered(
             bus, static_cast<GstMessageType>(GST_MESSAGE_ELEMENT | GST_MESSAGE_ERROR))) {
    EXPECT_NE(GST_MESSAGE_TYPE(message), GST_MESSAGE_ERROR) << text_of(message);
    const GstStructure* text = gst_message_get_structure(message);
    if (gst_structure_has_name(text, name.c_str()))
      found.emplace_back(gst_structure_copy(text), &gst_structure_free);
    gst_message_unref(message);
  }
  return found;
}

}  // namespace inverse::testing

namespace {

/// Writes where the process crashes to stderr: of a crash that comes once in many runs, nothing
/// else is left. Sanitizers do so themselves.
void trace_crash() {
  struct sigaction before {};
  sigaction(SIGSEGV, nullptr, &before);
  if (before.sa_handler != SIG_DFL) return;
  std::array<void*, 1> loads;
  backtrace(loads.data(), 1);  // its library, which must not happen in the handler
  struct sigaction action {};
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  action.sa_handler = [](int signal) {
    std::array<void*, 40> frames;
    const int found = backtrace(frames.data(), int{frames.size()});
    backtrace_symbols_fd(frames.data(), found, 2);
    raise(signal);
  };
  for (const int signal : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT})
    sigaction(signal, &action, nullptr);
}

}  // namespace

int main(int count, char** arguments) {
  trace_crash();
  ::testing::InitGoogleTest(&count, arguments);
  const inverse::testing::TemporaryFolder data;  // of the user, for presets
  setenv("XDG_DATA_HOME", data.path().c_str(), 1);
  gst_init(&count, &arguments);
  const int served = inverse::testing::serve(count, arguments);
  if (served >= 0) return served;
  ::testing::AddGlobalTestEnvironment(&inverse::testing::DeviceHolder::get());
  return RUN_ALL_TESTS();
}
