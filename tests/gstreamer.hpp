// SPDX-License-Identifier: LGPL-2.1-or-later
// What tests read of GStreamer's objects.
#pragma once
#include <gst/gst.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace inverse::testing {

struct Unref {
  void operator()(GstBuffer* buffer) const { gst_buffer_unref(buffer); }
};
using Buffer = std::unique_ptr<GstBuffer, Unref>;

inline std::vector<uint8_t> bytes_of(GstBuffer* buffer) {
  std::vector<uint8_t> bytes(gst_buffer_get_size(buffer));
  gst_buffer_extract(buffer, 0, bytes.data(), bytes.size());
  return bytes;
}

/// Empty for null.
inline std::vector<float> floats_of(GBytes* bytes) {
  if (!bytes) return {};
  gsize size = 0;
  const auto* data = static_cast<const float*>(g_bytes_get_data(bytes, &size));
  return {data, data + size / sizeof(float)};
}

/// The text of an error or a warning; empty for other messages.
inline std::string text_of(GstMessage* message) {
  GError* error = nullptr;
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR)
    gst_message_parse_error(message, &error, nullptr);
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING)
    gst_message_parse_warning(message, &error, nullptr);
  std::string text = error ? error->message : "";
  g_clear_error(&error);
  return text;
}

/// The text of the first message of this type within so many seconds; empty without one. Messages
/// before it are gone then.
inline std::string next_text(GstBus* bus, GstMessageType type, double seconds) {
  GstMessage* message =
      gst_bus_timed_pop_filtered(bus, static_cast<GstClockTime>(seconds * GST_SECOND), type);
  if (!message) return "";
  std::string text = text_of(message);
  gst_message_unref(message);
  return text;
}

/// Texts of errors, or of warnings, posted so far; all other messages are gone then.
inline std::vector<std::string> texts_of(GstBus* bus, GstMessageType type) {
  std::vector<std::string> texts;
  while (GstMessage* message = gst_bus_pop_filtered(bus, type)) {
    texts.push_back(text_of(message));
    gst_message_unref(message);
  }
  return texts;
}

/// The element of this name in a pipeline, which keeps it; null if there is none.
inline GstElement* find_element(GstElement* pipeline, const char* name) {
  GstElement* found = gst_bin_get_by_name(GST_BIN(pipeline), name);
  if (found) gst_object_unref(found);
  return found;
}

/// Calls `see` with each buffer that passes a pad of an element.
inline void watch_buffers(GstElement* element, const char* pad,
                          std::function<void(GstBuffer*)> see) {
  using See = std::function<void(GstBuffer*)>;
  GstPad* watched = gst_element_get_static_pad(element, pad);
  gst_pad_add_probe(
      watched, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad*, GstPadProbeInfo* info, gpointer data) {
        (*static_cast<See*>(data))(GST_PAD_PROBE_INFO_BUFFER(info));
        return GST_PAD_PROBE_OK;
      },
      new See(std::move(see)), [](gpointer data) { delete static_cast<See*>(data); });
  gst_object_unref(watched);
}

}  // namespace inverse::testing
