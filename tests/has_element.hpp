#pragma once
#include <gst/gst.h>

namespace inverse::testing {

/// Whether there is such an element: some are built only where their libraries are.
inline bool has_element(const char* name) {
  GstElementFactory* factory = gst_element_factory_find(name);
  if (factory) gst_object_unref(factory);
  return factory;
}

}  // namespace inverse::testing
