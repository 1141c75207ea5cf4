// SPDX-License-Identifier: LGPL-2.1-or-later
/* Paints one object of a video in another color, from frames in memory to frames in memory.

   Build:
     cc -O2 -o repaint repaint.c \
       $(pkg-config --cflags --libs gstreamer-app-1.0 gstreamer-video-1.0)

   It reads PPM pictures (P6), one after the other, and writes them with the object at (X, Y) of the
   first one painted:
     gst-launch-1.0 -q filesrc location=clip.webm ! decodebin ! videoconvert ! \
       video/x-raw,format=RGB ! pnmenc ! fdsink | ./repaint X Y 0xff2040c0 >out.ppm */
#include <gst/app/gstappsink.h>
#include <gst/app/gstappsrc.h>
#include <gst/video/video.h>
#include <stdio.h>
#include <stdlib.h>

enum { kFramesPerSecond = 25, kMaxSide = 16384 };

// Reads or writes the pixels of a buffer. Rows of GStreamer's RGB are padded to four bytes.
static gboolean copy_rows(const GstVideoInfo* info, GstBuffer* buffer, GstMapFlags flags,
                          FILE* file) {
  GstVideoFrame frame;
  if (!gst_video_frame_map(&frame, info, buffer, flags)) return FALSE;
  const size_t row = 3 * (size_t)GST_VIDEO_INFO_WIDTH(info);
  gboolean good = TRUE;
  for (int y = 0; good && y < GST_VIDEO_INFO_HEIGHT(info); ++y) {
    guint8* pixels = (guint8*)GST_VIDEO_FRAME_PLANE_DATA(&frame, 0) +
                     (size_t)y * GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0);
    good =
        (flags & GST_MAP_WRITE ? fread(pixels, 1, row, file) : fwrite(pixels, 1, row, file)) == row;
  }
  gst_video_frame_unmap(&frame);
  return good;
}

// Reads the next picture. Returns NULL with `ended` at the end of the input, and without if it is
// no complete PPM.
static GstBuffer* read_picture(FILE* in, GstVideoInfo* info, gboolean* ended) {
  int width, height, max;
  const int first = fgetc(in);
  *ended = first == EOF;
  if (first != 'P' || fscanf(in, "6 %d %d %d", &width, &height, &max) != 3 || fgetc(in) == EOF ||
      max != 255 || width < 1 || height < 1 || width > kMaxSide || height > kMaxSide ||
      !gst_video_info_set_format(info, GST_VIDEO_FORMAT_RGB, width, height))
    return NULL;
  GST_VIDEO_INFO_FPS_N(info) = kFramesPerSecond;
  GST_VIDEO_INFO_FPS_D(info) = 1;
  GstBuffer* buffer = gst_buffer_new_allocate(NULL, GST_VIDEO_INFO_SIZE(info), NULL);
  if (!copy_rows(info, buffer, GST_MAP_WRITE, in)) gst_clear_buffer(&buffer);
  return buffer;
}

// Called when the pipeline has used up its frames, so that none wait in memory.
static void on_need_data(GstAppSrc* source, guint size, gpointer user_data) {
  (void)size;
  guint64* count = user_data;
  GstVideoInfo info;
  gboolean ended;
  GstBuffer* buffer = read_picture(stdin, &info, &ended);
  if (ended) {
    gst_app_src_end_of_stream(source);
    return;
  }
  if (!buffer) {
    GST_ELEMENT_ERROR(source, STREAM, DECODE,
                      ("picture %" G_GUINT64_FORMAT " is no complete PPM (P6, 8 bits)", *count),
                      (NULL));
    return;
  }
  // Time stamps and duration: elements that follow objects need them.
  GST_BUFFER_PTS(buffer) = gst_util_uint64_scale(*count, GST_SECOND, kFramesPerSecond);
  GST_BUFFER_DURATION(buffer) = GST_SECOND / kFramesPerSecond;
  ++*count;
  GstCaps* caps = gst_video_info_to_caps(&info);
  gst_app_src_set_caps(source, caps);  // does nothing if they are the same
  gst_caps_unref(caps);
  gst_app_src_push_buffer(source, buffer);  // takes the buffer
}

// Called with each frame that comes out.
static GstFlowReturn on_new_sample(GstAppSink* sink, gpointer user_data) {
  (void)user_data;
  GstSample* sample = gst_app_sink_pull_sample(sink);
  if (!sample) return GST_FLOW_EOS;
  GstVideoInfo info;
  const gboolean good =
      gst_video_info_from_caps(&info, gst_sample_get_caps(sample)) &&
      printf("P6\n%d %d\n255\n", GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)) > 0 &&
      copy_rows(&info, gst_sample_get_buffer(sample), GST_MAP_READ, stdout) && fflush(stdout) == 0;
  gst_sample_unref(sample);
  if (good) return GST_FLOW_OK;
  GST_ELEMENT_ERROR(sink, RESOURCE, WRITE, ("cannot write a picture"), (NULL));
  return GST_FLOW_ERROR;
}

// Plays to the end and prints warnings and errors; returns the exit status.
static int play(GstElement* pipeline) {
  GstBus* bus = gst_element_get_bus(pipeline);
  int status = -1;
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  while (status < 0) {
    GstMessage* message = gst_bus_timed_pop_filtered(
        bus, GST_CLOCK_TIME_NONE, GST_MESSAGE_EOS | GST_MESSAGE_ERROR | GST_MESSAGE_WARNING);
    GError* error = NULL;
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS) {
      status = 0;
    } else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
      gst_message_parse_error(message, &error, NULL);
      status = 1;
    } else {
      gst_message_parse_warning(message, &error, NULL);
    }
    if (error) fprintf(stderr, "repaint: %s: %s\n", GST_MESSAGE_SRC_NAME(message), error->message);
    g_clear_error(&error);
    gst_message_unref(message);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(bus);
  return status;
}

int main(int argc, char** argv) {
  char *x_end, *y_end, *color_end;
  if (argc != 4) {
    fprintf(stderr, "usage: repaint X Y COLOR <IN.ppm >OUT.ppm    COLOR: 0xAARRGGBB\n");
    return 2;
  }
  const long x = strtol(argv[1], &x_end, 10), y = strtol(argv[2], &y_end, 10);
  const unsigned long color = strtoul(argv[3], &color_end, 0);
  if (*x_end || *y_end || *color_end || color > G_MAXUINT32) {
    fprintf(stderr, "repaint: X and Y are whole numbers, COLOR is 0xAARRGGBB\n");
    return 2;
  }
  gst_init(NULL, NULL);

  GError* error = NULL;
  GstElement* pipeline = gst_parse_launch(
      "appsrc name=in format=time ! intrinsicdecomp ! intrinsicselect name=select ! "
      "intrinsicrecolor name=recolor ! intrinsiccompose ! video/x-raw,format=RGB ! "
      "appsink name=out sync=false",
      &error);
  if (error) {
    fprintf(stderr, "repaint: %s\n", error->message);
    g_clear_error(&error);
    if (pipeline) gst_object_unref(pipeline);
    return 1;
  }

  // Properties can also change while it plays: another click replaces the strokes.
  char* strokes = g_strdup_printf("[{\"kind\":\"add\",\"points\":[[%ld,%ld]]}]", x, y);
  GstElement* select = gst_bin_get_by_name(GST_BIN(pipeline), "select");
  GstElement* recolor = gst_bin_get_by_name(GST_BIN(pipeline), "recolor");
  g_object_set(select, "strokes", strokes, NULL);
  g_object_set(recolor, "target", (guint)color, NULL);
  g_free(strokes);

  guint64 count = 0;
  GstElement* in = gst_bin_get_by_name(GST_BIN(pipeline), "in");
  GstElement* out = gst_bin_get_by_name(GST_BIN(pipeline), "out");
  GstAppSrcCallbacks on_input = {.need_data = on_need_data};
  GstAppSinkCallbacks on_output = {.new_sample = on_new_sample};
  gst_app_src_set_callbacks(GST_APP_SRC(in), &on_input, &count, NULL);
  gst_app_sink_set_callbacks(GST_APP_SINK(out), &on_output, NULL, NULL);

  const int status = play(pipeline);
  gst_object_unref(select);
  gst_object_unref(recolor);
  gst_object_unref(in);
  gst_object_unref(out);
  gst_object_unref(pipeline);
  return status;
}
