// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "kernels/image/format/transfer.hpp"

namespace inverse {

/// Linear RGB of a 0xAARRGGBB sRGB color property.
inline std::array<float, 3> linear_color(uint32_t argb) {
  static const Transfer srgb = Transfer::of(TransferFunction::srgb);
  const auto channel = [&](uint32_t shift) {
    return static_cast<float>(srgb.decode((argb >> shift & 255) / 255.0));
  };
  return {channel(16), channel(8), channel(0)};
}

/// The opaque 0xAARRGGBB sRGB color nearest to linear RGB.
inline uint32_t srgb_color(const std::array<float, 3>& linear) {
  static const Transfer srgb = Transfer::of(TransferFunction::srgb);
  uint32_t argb = 255;
  for (const float channel : linear) {
    const double bounded = channel > 0 ? std::min(channel, 1.0f) : 0.0;
    argb = argb << 8 | static_cast<uint32_t>(std::lround(srgb.encode(bounded) * 255));
  }
  return argb;
}

/// Sets `field` to an array of such colors.
inline void set_color_list(GstStructure* structure, const char* field,
                           const std::vector<guint>& colors) {
  GValue list = G_VALUE_INIT;
  gst_value_array_init(&list, static_cast<guint>(colors.size()));
  for (const guint color : colors) {
    GValue entry = G_VALUE_INIT;
    g_value_init(&entry, G_TYPE_UINT);
    g_value_set_uint(&entry, color);
    gst_value_array_append_and_take_value(&list, &entry);
  }
  gst_structure_take_value(structure, field, &list);
}

}  // namespace inverse
