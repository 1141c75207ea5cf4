// SPDX-License-Identifier: LGPL-2.1-or-later
#include "errors.hpp"

#include "log.hpp"

namespace inverse {

void post_error(GstElement* element, const Error& error) {
  GST_CAT_ERROR_OBJECT(log_of(element).category, element, "%s", error.what());
  // One macro call a code: GST_ELEMENT_ERROR pastes its domain and code.
  switch (error.kind()) {
    case ErrorKind::no_device:
      GST_ELEMENT_ERROR(element, RESOURCE, NOT_FOUND, ("%s", error.what()), (nullptr));
      break;
    case ErrorKind::device_lost:
      GST_ELEMENT_ERROR(element, RESOURCE, FAILED, ("%s", error.what()), (nullptr));
      break;
    case ErrorKind::out_of_memory:
      GST_ELEMENT_ERROR(element, RESOURCE, NO_SPACE_LEFT, ("%s", error.what()), (nullptr));
      break;
    case ErrorKind::limit:
    case ErrorKind::unsupported:
      GST_ELEMENT_ERROR(element, STREAM, FORMAT, ("%s", error.what()), (nullptr));
      break;
    case ErrorKind::file:
      GST_ELEMENT_ERROR(element, RESOURCE, READ, ("%s", error.what()), (nullptr));
      break;
    case ErrorKind::output:
      GST_ELEMENT_ERROR(element, RESOURCE, WRITE, ("%s", error.what()), (nullptr));
      break;
    case ErrorKind::connection:
      GST_ELEMENT_ERROR(element, RESOURCE, OPEN_READ_WRITE, ("%s", error.what()), (nullptr));
      break;
    case ErrorKind::internal:
      GST_ELEMENT_ERROR(element, LIBRARY, FAILED, ("%s", error.what()), (nullptr));
      break;
  }
}

}  // namespace inverse
