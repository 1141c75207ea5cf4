// SPDX-License-Identifier: LGPL-2.1-or-later
// The elements of this folder, in the plugin inverse.
#include <gst/gst.h>

#include "gst/depth/meta/depth_meta.hpp"

namespace inverse {
gboolean register_depth(GstPlugin* plugin);
gboolean register_rgbdmerge(GstPlugin* plugin);
gboolean register_rgbdsrc(GstPlugin* plugin);
gboolean register_rgbdtestsrc(GstPlugin* plugin);

gboolean register_depth(GstPlugin* plugin) {
  register_depth_meta();
  return register_rgbdmerge(plugin) && register_rgbdsrc(plugin) && register_rgbdtestsrc(plugin);
}

}  // namespace inverse
