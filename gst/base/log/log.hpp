// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

namespace inverse {

/// Where an element's messages for developers go (GST_DEBUG): the category that is named like the
/// element, and the element. For GST_CAT_INFO_OBJECT(log.category, log.object, …) and its like,
/// which format nothing while the category's level is off. Cheap to copy.
struct Log {
  GstDebugCategory* category;
  GstElement* object = nullptr;
};

/// The debug category of an element: made by the first call, found again by later ones.
/// `description` is one line for `gst-launch-1.0 --gst-debug-help`.
GstDebugCategory* debug_category(const char* factory, const char* description);

/// Of an element that was registered; else the category "inverse".
Log log_of(GstElement* element);

/// Logs a warning and posts it on the bus.
void post_warning(const Log& log, GQuark domain, gint code, const char* format, ...)
    G_GNUC_PRINTF(4, 5);

}  // namespace inverse
