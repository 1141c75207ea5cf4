// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

namespace inverse::testing {

/// Whether an element exists: some are built only if their libraries are installed.
inline bool has_element(const char* name) {
  GstElementFactory* factory = gst_element_factory_find(name);
  if (factory) gst_object_unref(factory);
  return factory;
}

}  // namespace inverse::testing
