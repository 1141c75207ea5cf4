// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <optional>

#include "gst/edit/layer_pictures.hpp"

namespace inverse {

/// How intrinsicsplit made the pictures of a pad. A sticky event says so ahead of them, which
/// effects pass on; with it, they can be made again from the same layers.
struct SentPicture {
  SplitLayer layer = SplitLayer::shading;
  GstVideoInfo info{};
  /// Of the layers.
  GstVideoColorPrimaries primaries = GST_VIDEO_COLOR_PRIMARIES_UNKNOWN;
  SplitParams params;
  bool edited = false;  ///< they showed layers that an editor had changed

  bool operator==(const SentPicture& other) const;
  bool linear() const { return params.encoding == SplitParams::Encoding::linear; }
  /// Factor on the layer before it was clipped at 1.
  float gain() const;
  /// New reference.
  GstEvent* event() const;
  /// What an event says; none if it is another event.
  static std::optional<SentPicture> of(GstEvent* event);
};

/// Whether frames of these descriptions lie in memory in the same way and have the same colors.
bool same_pictures(const GstVideoInfo& a, const GstVideoInfo& b);

}  // namespace inverse
