// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include "common/error.hpp"
#include "log.hpp"

namespace inverse {

/// Posts `error` as one element error message, or as a warning, with the domain and code that fit
/// its kind.
void post_error(GstElement* element, const Error& error);
void post_warning(const Log& log, const Error& error);

/// Runs `work`; on an exception posts it as an element error and returns false. Nothing escapes.
template <typename Work>
bool guarded(GstElement* element, Work work) {
  try {
    work();
    return true;
  } catch (const Error& error) {
    post_error(element, error);
  } catch (const std::bad_alloc&) {
    post_error(element, Error(ErrorKind::out_of_memory, "out of memory; use a smaller frame"));
  } catch (const std::exception& error) {
    post_error(element, Error(ErrorKind::internal, error.what()));
  }
  return false;
}

/// Runs `work`; on an exception posts it as a warning and returns false. Nothing escapes.
template <typename Work>
bool warn_on_error(const Log& log, Work work) {
  try {
    work();
    return true;
  } catch (const Error& error) {
    post_warning(log, error);
  } catch (const std::exception& error) {
    post_warning(log, Error(ErrorKind::internal, error.what()));
  }
  return false;
}

}  // namespace inverse
