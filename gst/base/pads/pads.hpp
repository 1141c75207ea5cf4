// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <memory>
#include <string>
#include <vector>

namespace inverse {

struct UnrefObject {
  void operator()(gpointer object) const { gst_object_unref(object); }
};
using PadPtr = std::unique_ptr<GstPad, UnrefObject>;
using ElementPtr = std::unique_ptr<GstElement, UnrefObject>;

/// The pad of an element, not of a bin, that is linked to `pad`, through the walls of bins; null if
/// there is none.
PadPtr linked_pad(GstPad* pad);

/// The pads on the other side of the pad's element that its data passes to or comes from.
std::vector<PadPtr> pads_behind(GstPad* pad);

/// The element of a pad; null if it has none.
ElementPtr element_of_pad(GstPad* pad);

/// Lets the properties of an element that are controlled follow the stream time of a frame that
/// comes in at `sink`.
void sync_controlled(GstElement* element, GstPad* sink, GstBuffer* buffer);

/// The name of a pad.
std::string name_of(GstPad* pad);

/// How messages name an element: by its name, and by its kind if that does not tell. Empty for
/// null.
std::string label_of(GstElement* element);

}  // namespace inverse
