// SPDX-License-Identifier: LGPL-2.1-or-later
#include "media.hpp"

#include <gst/app/gstappsink.h>
#include <gst/video/video.h>
#include <gtest/gtest.h>

#include <cstring>
#include <mutex>

#include "tests/gstreamer.hpp"

namespace inverse::testing {
namespace {

constexpr const char* kStreams =
    "video/x-raw; audio/mpeg; audio/x-vorbis; audio/x-opus; audio/x-flac; audio/x-ac3; "
    "audio/x-raw";

struct Reader {
  GstElement* pipeline;
  std::mutex mutex;
  Media media;
};

Image to_image(GstSample* sample) {
  GstVideoInfo info;
  Image image;
  if (!gst_video_info_from_caps(&info, gst_sample_get_caps(sample))) return image;
  GstVideoFrame frame;
  if (!gst_video_frame_map(&frame, &info, gst_sample_get_buffer(sample), GST_MAP_READ))
    return image;
  image.width = info.width;
  image.height = info.height;
  image.rgb.resize(static_cast<size_t>(info.width) * info.height * 3);
  for (int y = 0; y < info.height; ++y)
    memcpy(&image.rgb[static_cast<size_t>(y) * info.width * 3],
           static_cast<uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0)) +
               static_cast<ptrdiff_t>(y) * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0),
           static_cast<size_t>(info.width) * 3);
  gst_video_frame_unmap(&frame);
  return image;
}

GstFlowReturn on_frame(GstAppSink* sink, Reader* reader) {
  GstSample* sample = gst_app_sink_pull_sample(sink);
  {
    std::lock_guard lock(reader->mutex);
    reader->media.frames.push_back(to_image(sample));
    reader->media.times.push_back(GST_BUFFER_PTS(gst_sample_get_buffer(sample)));
  }
  gst_sample_unref(sample);
  return GST_FLOW_OK;
}

GstFlowReturn on_packet(GstAppSink* sink, Reader* reader) {
  GstSample* sample = gst_app_sink_pull_sample(sink);
  {
    std::lock_guard lock(reader->mutex);
    const auto index = GPOINTER_TO_UINT(g_object_get_data(G_OBJECT(sink), "inverse-index"));
    reader->media.sounds[index].packets.push_back(bytes_of(gst_sample_get_buffer(sample)));
  }
  gst_sample_unref(sample);
  return GST_FLOW_OK;
}

void on_pad(GstElement*, GstPad* pad, Reader* reader) {
  GstCaps* caps = gst_pad_get_current_caps(pad);
  const bool video = gst_structure_has_name(gst_caps_get_structure(caps, 0), "video/x-raw");
  GstElement* branch = gst_parse_bin_from_description(
      video ? "videoconvert ! video/x-raw,format=RGB ! appsink name=out"
            : "queue ! appsink name=out",
      TRUE, nullptr);
  GstElement* sink = find_element(branch, "out");
  g_object_set(sink, "sync", FALSE, "emit-signals", TRUE, nullptr);
  if (!video) {
    std::lock_guard lock(reader->mutex);
    gchar* text = gst_caps_to_string(caps);
    reader->media.sounds.push_back({text, {}});
    g_free(text);
    g_object_set_data(G_OBJECT(sink), "inverse-index",
                      GUINT_TO_POINTER(reader->media.sounds.size() - 1));
  }
  g_signal_connect(sink, "new-sample", video ? G_CALLBACK(on_frame) : G_CALLBACK(on_packet),
                   reader);
  gst_caps_unref(caps);
  gst_bin_add(GST_BIN(reader->pipeline), branch);
  GstPad* in = gst_element_get_static_pad(branch, "sink");
  gst_pad_link(pad, in);
  gst_object_unref(in);
  gst_element_sync_state_with_parent(branch);
}

/// Plays a pipeline to its end; returns the error text, empty on success.
std::string play(GstElement* pipeline, unsigned seconds) {
  GstBus* bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  GstMessage* message = gst_bus_timed_pop_filtered(
      bus, seconds * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  std::string error_text = message ? text_of(message) : "did not end";
  if (message) gst_message_unref(message);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(bus);
  return error_text;
}

template <class F>
void each_pixel(const Image& image, double left, double top, double right, double bottom, F f) {
  for (int y = static_cast<int>(top * image.height); y < static_cast<int>(bottom * image.height);
       ++y)
    for (int x = static_cast<int>(left * image.width); x < static_cast<int>(right * image.width);
         ++x)
      f(&image.rgb[(static_cast<size_t>(y) * image.width + x) * 3]);
}

}  // namespace

double Image::mean(int channel, double left, double top, double right, double bottom) const {
  double sum = 0, count = 0;
  each_pixel(*this, left, top, right, bottom, [&](const uint8_t* p) {
    sum += p[channel];
    ++count;
  });
  return count > 0 ? sum / count : 0;
}

double Image::variance(double left, double top, double right, double bottom) const {
  double sum = 0, squares = 0, count = 0;
  each_pixel(*this, left, top, right, bottom, [&](const uint8_t* p) {
    const double value = (p[0] + p[1] + p[2]) / 3.0;
    sum += value;
    squares += value * value;
    ++count;
  });
  return count > 0 ? squares / count - sum / count * (sum / count) : 0;
}

Media read_media(const std::string& path, unsigned seconds) {
  Reader reader;
  gchar* uri = gst_filename_to_uri(path.c_str(), nullptr);
  reader.pipeline = gst_pipeline_new(nullptr);
  GstElement* decoder = gst_element_factory_make("uridecodebin", nullptr);
  g_object_set(decoder, "uri", uri, nullptr);
  gst_util_set_object_arg(G_OBJECT(decoder), "caps", kStreams);
  g_signal_connect(decoder, "pad-added", G_CALLBACK(on_pad), &reader);
  gst_bin_add(GST_BIN(reader.pipeline), decoder);
  g_free(uri);
  const std::string error = play(reader.pipeline, seconds);
  if (!error.empty()) reader.media.errors.push_back(path + ": " + error);
  gst_object_unref(reader.pipeline);
  return std::move(reader.media);
}

void expect_video(const Media& media, int width, int height, size_t min_frames) {
  EXPECT_TRUE(media.errors.empty()) << media.errors.front();
  ASSERT_GE(media.frames.size(), min_frames);
  for (size_t i = 0; i < media.frames.size(); ++i) {
    const Image& frame = media.frames[i];
    ASSERT_EQ(frame.width, width) << "frame " << i;
    ASSERT_EQ(frame.height, height) << "frame " << i;
    EXPECT_GT(frame.variance(), 100) << "frame " << i << " is flat";
    EXPECT_GT((frame.mean(0) + frame.mean(1) + frame.mean(2)) / 3, 16)
        << "frame " << i << " is black";
    ASSERT_TRUE(GST_CLOCK_TIME_IS_VALID(media.times[i])) << "frame " << i;
    if (i > 0) {
      EXPECT_GT(media.times[i], media.times[i - 1]) << "frame " << i;
    }
  }
}

void make_media(const std::string& path, const std::string& line) {
  GError* error = nullptr;
  GstElement* pipeline = gst_parse_launch((line + " ! filesink name=file").c_str(), &error);
  ASSERT_FALSE(error) << line << ": " << error->message;
  g_object_set(find_element(pipeline, "file"), "location", path.c_str(), nullptr);
  EXPECT_EQ(play(pipeline, 60), "") << line;
  gst_object_unref(pipeline);
}

}  // namespace inverse::testing
