// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/app/gstappsink.h>
#include <gst/check/gstharness.h>
#include <gst/video/video.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "tests/expect_error.hpp"
#include "tests/gstreamer.hpp"

namespace inverse::testing {

/// What became of a launch line: how it ended, what it complained about, and the frames that
/// reached its appsink.
struct LineResult {
  bool eos = false;
  std::vector<std::string> errors;  ///< "factory: text", in the order of arrival
  std::vector<std::string> warnings;
  std::vector<std::string> messages;  ///< names of element messages
  std::vector<std::vector<uint8_t>> frames;
  GstVideoInfo info{};  ///< of the last frame
  /// The error of our own elements, or of the first complaint.
  std::string first_error() const { return errors.empty() ? "" : errors.front(); }
};

/// Runs a launch line to its end. Frames are kept where it has an `appsink name=out`. Fails the
/// test where it neither ends nor complains within `seconds`. `prepare` may do to the pipeline what
/// an application does before it starts.
LineResult run_line(const std::string& line, unsigned seconds = 60,
                    const std::function<void(GstElement* pipeline)>& prepare = {});

/// The same line run to its end so many times, by one pipeline that is stopped (NULL) in between.
/// `between` is called before each run but the first.
std::vector<LineResult> run_line_again(const std::string& line, size_t times,
                                       const std::function<void()>& between);

/// The tests share the plugin's device, whose kernels are then built once for all of them. While
/// one of these lives, it is closed between streams: each begins with no kernel built.
class NewDevice {
 public:
  NewDevice();
  NewDevice(const NewDevice&) = delete;
  NewDevice& operator=(const NewDevice&) = delete;
  ~NewDevice();
};

/// Flushes as a seek does: flush-start, flush-stop, a new segment in time.
void flush(GstHarness* harness);
/// Whether the memory of a buffer can be read; that of layers cannot.
bool has_pixels(GstBuffer* buffer);
/// The caps of what comes out of a harness; empty if there are none.
std::string caps_out_of(GstHarness* harness);

/// A harness around a piece of a launch line with video caps on both sides.
class VideoHarness {
 public:
  /// `line` is what gst_harness_new_parse takes. `sink_caps` empty: anything.
  VideoHarness(const std::string& line, const std::string& src_caps,
               const std::string& sink_caps = {});
  VideoHarness(const VideoHarness&) = delete;
  VideoHarness& operator=(const VideoHarness&) = delete;
  ~VideoHarness();

  /// Caps of raw video as a string.
  static std::string caps(const std::string& format, int width, int height,
                          const std::string& more = {});

  /// Pushes one frame, timestamped 1/25 s after the last; returns the flow.
  GstFlowReturn push(const std::vector<uint8_t>& bytes);
  /// Pushes a frame and takes what comes out; empty if nothing does within a minute, which is
  /// for machines that do much else, not for what an element may take.
  std::vector<uint8_t> process(const std::vector<uint8_t>& bytes);
  /// The same so many times, each of which something has to come out; returns the last.
  std::vector<uint8_t> process(const std::vector<uint8_t>& bytes, int times);
  /// The same with all that a buffer has; null if nothing comes out.
  Buffer process_buffer(const std::vector<uint8_t>& bytes);
  std::vector<uint8_t> pull();
  /// Pushes a frame with a timestamp of one's own, marked as coming after a gap, and drops what
  /// comes out.
  void push_after_gap(const std::vector<uint8_t>& bytes, GstClockTime time);
  /// The timestamp of the next frame that is pushed.
  void set_next_time(GstClockTime time) { time_ = time; }
  /// Flushes as a seek does: flush-start, flush-stop, a new segment in time.
  void flush() { inverse::testing::flush(harness_); }
  /// Sends an event upstream, as a sink does.
  void send_upstream(GstEvent* event) { gst_harness_push_upstream_event(harness_, event); }
  /// Texts of errors, or of warnings, posted on the bus so far; all others are gone then.
  std::vector<std::string> errors() { return texts(GST_MESSAGE_ERROR); }
  std::vector<std::string> warnings() { return texts(GST_MESSAGE_WARNING); }
  /// The element of this name or factory inside the line. Borrowed.
  GstElement* find(const std::string& factory);
  GstHarness* harness() { return harness_; }
  GstBus* bus() { return bus_; }
  void set_src_caps(const std::string& caps);

 private:
  std::vector<std::string> texts(GstMessageType type);

  GstHarness* harness_;
  GstBus* bus_;
  GstClockTime time_ = 0;
};

/// What caps of raw video say.
GstVideoInfo info_of(const std::string& caps);
/// Random bytes of a frame of these caps.
std::vector<uint8_t> random_frame(const std::string& caps, unsigned seed);
/// Bytes of a frame of these caps with every byte the same.
std::vector<uint8_t> flat_frame(const std::string& caps, uint8_t value);
/// The bytes of a frame that are pixels: without the padding of its rows. Empty where the frame is
/// too short.
std::vector<uint8_t> visible(const GstVideoInfo& info, const std::vector<uint8_t>& frame);
std::vector<uint8_t> visible(const std::string& caps, const std::vector<uint8_t>& frame);
/// A pixel of a frame of RGBA.
inline const uint8_t* pixel_at(const std::vector<uint8_t>& frame, int x, int y, int width) {
  return &frame[4 * (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x))];
}
/// The largest difference between two frames, byte by byte; 256 where their sizes differ.
int largest_difference(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b);

template <typename T>
T property(GstElement* element, const char* name) {
  if constexpr (std::is_same_v<T, std::string>) {
    const std::unique_ptr<gchar, decltype(&g_free)> text(property<gchar*>(element, name), &g_free);
    return text ? text.get() : "";
  } else {
    T value{};
    if (GST_IS_CHILD_PROXY(element))
      gst_child_proxy_get(GST_CHILD_PROXY(element), name, &value, nullptr);
    else
      g_object_get(element, name, &value, nullptr);
    return value;
  }
}

/// Sets a property of an element or of its child ("strokes::mode") as a launch line does.
inline void set_text(GstElement* element, const char* name, const char* text) {
  GObject* owner = nullptr;
  GParamSpec* spec = nullptr;
  ASSERT_TRUE(gst_child_proxy_lookup(GST_CHILD_PROXY(element), name, &owner, &spec)) << name;
  gst_util_set_object_arg(owner, spec->name, text);
  g_object_unref(owner);
}

/// A field of a structure; nothing if it is missing or of another type.
template <typename T>
std::optional<T> field(const GstStructure* structure, const char* name) {
  const GValue* value = gst_structure_get_value(structure, name);
  if (!value) return {};
  if constexpr (std::is_same_v<T, bool>) {
    if (G_VALUE_HOLDS_BOOLEAN(value)) return g_value_get_boolean(value);
  } else if constexpr (std::is_same_v<T, int>) {
    if (G_VALUE_HOLDS_INT(value)) return g_value_get_int(value);
  } else if constexpr (std::is_same_v<T, guint>) {
    if (G_VALUE_HOLDS_UINT(value)) return g_value_get_uint(value);
  } else if constexpr (std::is_same_v<T, guint64>) {
    if (G_VALUE_HOLDS_UINT64(value)) return g_value_get_uint64(value);
  } else if constexpr (std::is_same_v<T, double>) {
    if (G_VALUE_HOLDS_DOUBLE(value)) return g_value_get_double(value);
  } else {
    static_assert(std::is_same_v<T, std::string>);
    if (G_VALUE_HOLDS_STRING(value)) return g_value_get_string(value);
  }
  return {};
}

/// A field of `stats`, which can be written as text and read back; nothing if it is missing.
template <typename T>
std::optional<T> find_stat(GstElement* element, const char* name) {
  GstStructure* stats = nullptr;
  g_object_get(element, "stats", &stats, nullptr);
  std::optional<T> value = field<T>(stats, name);
  gchar* text = gst_structure_to_string(stats);
  GstStructure* read = gst_structure_from_string(text, nullptr);
  EXPECT_TRUE(read) << text;
  if (read) gst_structure_free(read);
  g_free(text);
  gst_structure_free(stats);
  return value;
}

/// A field of `stats`, which must be there.
template <typename T>
T stat(GstElement* element, const char* name) {
  const std::optional<T> value = find_stat<T>(element, name);
  EXPECT_TRUE(value) << "stats has no \"" << name << "\" of this type";
  return value.value_or(T{});
}

using Structure = std::unique_ptr<GstStructure, decltype(&gst_structure_free)>;
/// Element messages of this name posted since the last call, in order; all others are gone then.
/// An error among them fails the test.
std::vector<Structure> element_messages(GstBus* bus, const std::string& name);

}  // namespace inverse::testing
