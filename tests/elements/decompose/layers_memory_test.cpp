// SPDX-License-Identifier: LGPL-2.1-or-later
// What layers weigh in queues.
#include "tests/elements/element_test.hpp"
#include "tests/elements/layer_of.hpp"

namespace inverse::testing {

// Layers are on the device: what queues count is the size of memory that cannot be mapped.
TEST(LayersMeta, ABufferIsAsLargeAsItsLayers) {
  VideoHarness harness("intrinsicdecomp light-color-slope=0 ! queue",
                       VideoHarness::caps("RGBA", 40, 30),
                       "video/x-raw(meta:InverseLayers), format=RGBA, layers=(string)intrinsic");
  const Buffer out = harness.process_buffer(random_frame(VideoHarness::caps("RGBA", 40, 30), 1));
  ASSERT_NE(out, nullptr);
  EXPECT_EQ(gst_buffer_get_size(out.get()), 2U * 40 * 30 * 16);  // input and intrinsic = model
  EXPECT_FALSE(has_pixels(out.get()));
  const Buffer copy(gst_buffer_copy(out.get())), deep(gst_buffer_copy_deep(out.get()));
  for (GstBuffer* other : {copy.get(), deep.get()}) {
    EXPECT_EQ(gst_buffer_get_size(other), gst_buffer_get_size(out.get()));
    EXPECT_EQ(layer_of(other, GST_INVERSE_ROLE_INTRINSIC),
              layer_of(out.get(), GST_INVERSE_ROLE_INTRINSIC));
  }
}

TEST(LayersMeta, AQueueBeforeASlowSinkHoldsFewFrames) {
  const auto peak = [](const std::string& queue) {
    const NewDevice fresh;
    GstElement* decomposer = nullptr;
    const LineResult result = run_line(
        "videotestsrc num-buffers=40 pattern=ball ! video/x-raw,width=640,height=480 ! "
        "intrinsicdecomp name=d " +
            queue +
            "! intrinsiccompose ! identity sleep-time=30000 ! "
            "fakesink",
        60,
        [&](GstElement* pipeline) { decomposer = gst_bin_get_by_name(GST_BIN(pipeline), "d"); });
    EXPECT_EQ(result.first_error(), "");
    const auto bytes = stat<guint64>(decomposer, "device-bytes-peak");
    gst_object_unref(decomposer);
    return static_cast<double>(bytes);
  };
  const double without = peak(""), with = peak("! queue ");
  EXPECT_LE(with, 1.3 * without);
  RecordProperty("without", std::to_string(without));
  RecordProperty("with", std::to_string(with));
}

}  // namespace inverse::testing
