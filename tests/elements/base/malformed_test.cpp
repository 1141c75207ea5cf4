// SPDX-License-Identifier: LGPL-2.1-or-later
// Streams and buffers that are not what they say they are: one clear error, or a picture.
#include "tests/elements/element_test.hpp"
#include "tests/elements/layer_of.hpp"

namespace inverse::testing {
namespace {

/// A buffer of `bytes` whose meta claims RGBA or another format at this size, stride and offset.
GstBuffer* claiming(const std::vector<uint8_t>& bytes, GstVideoFormat format, guint width,
                    guint height, gint stride, gsize offset) {
  GstBuffer* buffer = gst_buffer_new_memdup(bytes.data(), bytes.size());
  gsize offsets[GST_VIDEO_MAX_PLANES] = {offset};
  gint strides[GST_VIDEO_MAX_PLANES] = {stride};
  gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, format, width, height, 1,
                                 offsets, strides);
  return buffer;
}

TEST(Malformed, AVideoMetaThatReachesBeyondItsMemoryIsOneClearError) {
  const std::string caps = VideoHarness::caps("RGBA", 1600, 1200);
  const std::vector<uint8_t> bytes(1024);
  GstBuffer* const buffers[] = {
      claiming(bytes, GST_VIDEO_FORMAT_RGBA, 1600, 1200, 6400, 0),   // rows after the end
      claiming(bytes, GST_VIDEO_FORMAT_RGBA, 1600, 1200, -6400, 0),  // rows before the start
      claiming(bytes, GST_VIDEO_FORMAT_RGBA, 1600, 1200, 0, 512),    // a row over the end
      claiming(bytes, GST_VIDEO_FORMAT_RGBA, 16, 16, 64, 0),         // a smaller frame
      claiming(bytes, GST_VIDEO_FORMAT_GRAY8, 1600, 1200, 1600, 0),  // another format
  };
  for (GstBuffer* buffer : buffers) {
    VideoHarness harness("intrinsicdecomp", caps, caps);
    EXPECT_EQ(gst_harness_push(harness.harness(), buffer), GST_FLOW_ERROR);
    expect_one(harness.errors(), "cannot hold the 1600x1200 RGBA frame");
  }
}

TEST(Malformed, OddAndNegativeStridesAreRead) {
  const std::string caps = VideoHarness::caps("RGBA", 16, 8);
  const auto frame = random_frame(caps, 3);
  VideoHarness plain("intrinsicdecomp show=input", caps, caps);
  const auto expected = plain.process(frame);
  ASSERT_EQ(expected.size(), frame.size());
  std::vector<uint8_t> odd(13 + 77 * 8), flipped(frame.size());
  for (size_t row = 0; row < 8; ++row) {
    memcpy(&odd[13 + row * 77], &frame[row * 64], 64);
    memcpy(&flipped[(7 - row) * 64], &frame[row * 64], 64);
  }
  for (GstBuffer* buffer : {claiming(odd, GST_VIDEO_FORMAT_RGBA, 16, 8, 77, 13),
                            claiming(flipped, GST_VIDEO_FORMAT_RGBA, 16, 8, -64, 448)}) {
    VideoHarness harness("intrinsicdecomp show=input", caps, caps);
    ASSERT_EQ(gst_harness_push(harness.harness(), buffer), GST_FLOW_OK);
    EXPECT_EQ(harness.pull(), expected);
  }
}

TEST(Malformed, AStreamCountedInBytesFlows) {
  // GStreamer reports a misused segment as a critical, which this makes fatal.
  const GLogLevelFlags before =
      g_log_set_always_fatal(static_cast<GLogLevelFlags>(G_LOG_FATAL_MASK | G_LOG_LEVEL_CRITICAL));
  const auto result = run_line(
      "fakesrc format=bytes num-buffers=3 sizetype=fixed sizemax=9216 ! "
      "video/x-raw,format=RGB,width=64,height=48,framerate=25/1 ! intrinsicdecomp ! "
      "intrinsicrecolor key=0xffc83c28 ! intrinsicsplit name=s s.reflectance ! appsink name=out");
  g_log_set_always_fatal(before);
  EXPECT_TRUE(result.eos) << result.first_error();
  EXPECT_EQ(result.frames.size(), 3u);
}

TEST(Malformed, LayersOfAnotherSizeThanTheirCapsAreOneClearError) {
  const std::string caps = VideoHarness::caps("RGBA", 64, 48);
  VideoHarness decomposer("intrinsicdecomp", caps, kLayers);
  const Buffer layers = decomposer.process_buffer(random_frame(caps, 1));
  for (const char* line : {"intrinsicrecolor", "intrinsiccompose"}) {
    VideoHarness editor(line,
                        std::string(kLayers) + ", format=RGBA, width=16, height=8, framerate=25/1");
    EXPECT_EQ(gst_harness_push(editor.harness(), gst_buffer_copy(layers.get())), GST_FLOW_ERROR);
    expect_one(editor.errors(), "layers of 64x48", "16x8");
  }
}

}  // namespace
}  // namespace inverse::testing
