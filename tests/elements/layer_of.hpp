// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <vector>

#include "gst/inverse/inverse_layers_meta.h"
#include "tests/gstreamer.hpp"

namespace inverse::testing {

/// Caps of layers.
inline constexpr const char* kLayers =
    "video/x-raw(" GST_CAPS_FEATURE_META_INVERSE_LAYERS "), layers=(string)intrinsic";

/// A layer of a buffer, vec4 pixels; empty if there is none.
inline std::vector<float> layer_of(GstBuffer* buffer, GstInverseRole role) {
  GstInverseLayersMeta* meta = gst_buffer_get_inverse_layers_meta(buffer);
  GBytes* bytes = meta ? meta->download(meta, role) : nullptr;
  std::vector<float> layer = floats_of(bytes);
  if (bytes) g_bytes_unref(bytes);
  return layer;
}

/// Replaces a layer of a buffer; whether that could be done.
inline bool replace_layer(GstBuffer* buffer, GstInverseRole role,
                          const std::vector<float>& values) {
  GstInverseLayersMeta* meta = gst_buffer_get_inverse_layers_meta(buffer);
  GBytes* bytes = g_bytes_new(values.data(), values.size() * sizeof(float));
  const bool replaced = meta && meta->upload(meta, role, bytes);
  g_bytes_unref(bytes);
  return replaced;
}

}  // namespace inverse::testing
