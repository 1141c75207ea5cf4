// SPDX-License-Identifier: LGPL-2.1-or-later
// An editor that was built with version 1 of the layers' header, in colored light.
#include "layers_meta_1.h"
#include "tests/elements/element_test.hpp"
#include "tests/srgb.hpp"

namespace inverse::testing {
namespace {

/// Halves reflectance, as such an editor would.
GstPadProbeReturn halve_reflectance(GstPad* /*pad*/, GstPadProbeInfo* info, gpointer data) {
  info->data = gst_buffer_make_writable(GST_PAD_PROBE_INFO_BUFFER(info));
  GstInverseLayersMeta* meta = gst_buffer_get_inverse_layers_meta(GST_PAD_PROBE_INFO_BUFFER(info));
  GBytes* bytes = meta->download(meta, GST_INVERSE_ROLE_INTRINSIC);
  std::vector<float> layer = floats_of(bytes);
  g_bytes_unref(bytes);
  for (size_t i = 0; i < layer.size(); ++i)
    if (i % 4 < 3) layer[i] *= 0.5F;
  bytes = g_bytes_new(layer.data(), layer.size() * sizeof(float));
  *static_cast<bool*>(data) = meta->upload(meta, GST_INVERSE_ROLE_INTRINSIC, bytes);
  g_bytes_unref(bytes);
  return GST_PAD_PROBE_OK;
}

/// Puts a meta of another build, whose layers are not to be touched, in place of a buffer's own.
GstPadProbeReturn replace_layers(GstPad* /*pad*/, GstPadProbeInfo* info, gpointer) {
  static const GstMetaInfo* const other = gst_meta_register(
      g_type_from_name(GST_INVERSE_LAYERS_META_API_NAME), "GstInverseLayersMeta-other",
      sizeof(GstInverseLayersMeta),
      [](GstMeta* meta, gpointer, GstBuffer*) -> gboolean {
        reinterpret_cast<GstInverseLayersMeta*>(meta)->layers = nullptr;
        return TRUE;
      },
      nullptr, nullptr);
  info->data = gst_buffer_make_writable(GST_PAD_PROBE_INFO_BUFFER(info));
  GstBuffer* buffer = GST_PAD_PROBE_INFO_BUFFER(info);
  gst_buffer_remove_meta(buffer, &gst_buffer_get_inverse_layers_meta(buffer)->meta);
  gst_buffer_add_meta(buffer, other, nullptr);
  return GST_PAD_PROBE_OK;
}

}  // namespace

TEST(LayersMeta, OfAnotherBuildIsRefused) {
  const std::string caps = VideoHarness::caps("RGBA", 48, 32);
  for (const char* editor :
       {"intrinsiccompose", "intrinsicsplit name=s s.shading ! videoconvert"}) {
    VideoHarness harness("intrinsicdecomp ! identity ! " + std::string(editor), caps);
    GstPad* pad = gst_element_get_static_pad(harness.find("identity"), "src");
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, replace_layers, nullptr, nullptr);
    gst_object_unref(pad);
    EXPECT_EQ(harness.push(random_frame(caps, 3)), GST_FLOW_ERROR);
    expect_one(harness.errors(), "a buffer without layers", "another build");
  }
}

TEST(LayersMeta, AnEditorOfVersionOneWorksInColoredLight) {
  const std::string caps = VideoHarness::caps("RGBA", 48, 32);
  for (const std::string slope : {"0", "0.9"}) {
    VideoHarness harness("intrinsicdecomp light-color-slope=" + slope +
                             " ! identity ! intrinsiccompose residual=none",
                         caps, caps);
    bool edited = false;
    GstPad* pad = gst_element_get_static_pad(harness.find("identity"), "src");
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, halve_reflectance, &edited, nullptr);
    gst_object_unref(pad);
    const auto frame = random_frame(caps, 3);
    const auto got = harness.process(frame);
    ASSERT_EQ(got.size(), frame.size());
    EXPECT_TRUE(edited);
    for (size_t i = 0; i < frame.size(); ++i)
      if (i % 4 < 3) {
        ASSERT_NEAR(srgb_light(float(got[i]) / 255), srgb_light(float(frame[i]) / 255) / 2, 0.006)
            << slope;
      }
  }
}

}  // namespace inverse::testing
