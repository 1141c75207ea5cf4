// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <optional>
#include <string>

namespace inverse {

/// What a buffer shows that is no frame of a camera but a drawn layer. Elements that decompose
/// frames warn of it. The mark stays on the picture where GStreamer's elements convert, scale or
/// crop it.
struct ViewMark {
  std::string element;  ///< that drew it, as messages name it
  std::string layer;    ///< "reflectance"
  std::string frame;    ///< what to do to that element to get the frame: "set show=input"
};

/// The frame without highlights, which all but limematerial may take for a frame.
inline constexpr const char* kDiffuseView = "diffuse";
/// Gradients A and B side by side, which only olatrelight takes.
inline constexpr const char* kGradientsView = "gradients";

/// Marks a buffer, in place of the mark that it has.
void mark_view(GstBuffer* buffer, const ViewMark& mark);

/// The mark of a buffer; none if it is a frame, as far as is known.
std::optional<ViewMark> view_mark(GstBuffer* buffer);

}  // namespace inverse
