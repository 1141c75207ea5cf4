// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <vector>

#include "gst/base/meta/inverse_layers_meta.h"

namespace inverse::testing {

/// A layer of a buffer, vec4 pixels; empty if there is none.
inline std::vector<float> layer_of(GstBuffer* buffer, GstInverseRole role) {
  GstInverseLayersMeta* meta = gst_buffer_get_inverse_layers_meta(buffer);
  GBytes* bytes = meta ? meta->download(meta, role) : nullptr;
  if (!bytes) return {};
  gsize size = 0;
  const auto* data = static_cast<const float*>(g_bytes_get_data(bytes, &size));
  std::vector<float> layer(data, data + size / sizeof(float));
  g_bytes_unref(bytes);
  return layer;
}

}  // namespace inverse::testing
