// SPDX-License-Identifier: LGPL-2.1-or-later
#include "log.hpp"

namespace inverse {

GstDebugCategory* debug_category(const char* factory, const char* description) {
#ifndef GST_DISABLE_GST_DEBUG
  // GStreamer keeps the first category of a name and returns it to whoever asks for it later.
  return _gst_debug_category_new(factory, 0, description);
#else
  return nullptr;
#endif
}

Log log_of(GstElement* element) {
  const GstElementFactory* factory = element ? gst_element_get_factory(element) : nullptr;
  return {factory ? debug_category(GST_OBJECT_NAME(factory), nullptr)
                  : debug_category("inverse", "inverse rendering elements"),
          element};
}

void post_warning(const Log& log, GQuark domain, gint code, const char* format, ...) {
  va_list values;
  va_start(values, format);
  gchar* text = g_strdup_vprintf(format, values);
  va_end(values);
  GST_CAT_WARNING_OBJECT(log.category, log.object, "%s", text);
  gst_element_message_full(log.object, GST_MESSAGE_WARNING, domain, code, text, nullptr, __FILE__,
                           GST_FUNCTION, __LINE__);
}

}  // namespace inverse
