// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

namespace inverse {

/// Pictures in a plain frame.
inline constexpr int kSideBySide = 2;

/// ElementInfo::plain_caps of an element that takes pictures side by side and sends one: widths of
/// plain caps are divided towards the source pad and multiplied towards the sink pad. If any width
/// may go out, those that leave a remainder pass, for `check_side_by_side` to refuse them.
GstCaps* transform_side_by_side(GstPadDirection direction, GstCaps* caps, GstCaps* templates,
                                GstCaps* filter);

/// Filter::check_plain of such an element.
void check_side_by_side(const char* element, const GstVideoInfo& in, const GstVideoInfo& out);

}  // namespace inverse
