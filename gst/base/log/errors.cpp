// SPDX-License-Identifier: LGPL-2.1-or-later
#include "errors.hpp"

#include <utility>

namespace inverse {

namespace {

/// The domain and code of GStreamer that fit.
std::pair<GQuark, gint> code_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::no_device:
      return {GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_NOT_FOUND};
    case ErrorKind::device_lost:
      return {GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_FAILED};
    case ErrorKind::out_of_memory:
      return {GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_NO_SPACE_LEFT};
    case ErrorKind::limit:
    case ErrorKind::unsupported:
      return {GST_STREAM_ERROR, GST_STREAM_ERROR_FORMAT};
    case ErrorKind::file:
      return {GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ};
    case ErrorKind::output:
      return {GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_WRITE};
    case ErrorKind::connection:
      return {GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_OPEN_READ_WRITE};
    case ErrorKind::internal:
      break;
  }
  return {GST_LIBRARY_ERROR, GST_LIBRARY_ERROR_FAILED};
}

}  // namespace

void post_error(GstElement* element, const Error& error) {
  GST_CAT_ERROR_OBJECT(log_of(element).category, element, "%s", error.what());
  const auto [domain, code] = code_of(error.kind());
  gst_element_message_full(element, GST_MESSAGE_ERROR, domain, code, g_strdup(error.what()),
                           nullptr, __FILE__, __func__, __LINE__);
}

void post_warning(const Log& log, const Error& error) {
  const auto [domain, code] = code_of(error.kind());
  post_warning(log, domain, code, "%s", error.what());
}

}  // namespace inverse
