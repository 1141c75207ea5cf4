// SPDX-License-Identifier: LGPL-2.1-or-later
// The elements of this folder, in the plugin inverse.
#include "gst/base/filter.hpp"

namespace inverse {
extern const ElementInfo kGlobalIntrinsicThesis;
extern const ElementInfo kIntrinsicDecompThesis;
gboolean register_thesis(GstPlugin* plugin);

gboolean register_thesis(GstPlugin* plugin) {
  return register_filter(plugin, kIntrinsicDecompThesis) &&
         register_filter(plugin, kGlobalIntrinsicThesis);
}

}  // namespace inverse
