// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

namespace inverse {

/// What several of our plugins in one process share by its name: the first one's serves all.
/// `make` registers it if it is not registered yet.
template <typename Make>
GType type_registered_once(const char* name, Make make) {
  const GType known = g_type_from_name(name);
  return known ? known : make();
}

template <typename Make>
const GstMetaInfo* meta_registered_once(const char* name, Make make) {
  const GstMetaInfo* known = gst_meta_get_info(name);
  return known ? known : make();
}

}  // namespace inverse
