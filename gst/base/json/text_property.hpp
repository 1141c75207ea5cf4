// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

#include "common/error.hpp"
#include "gst/base/log/log.hpp"

namespace inverse {

/// The value of a text property of the element that logs here, or of a child ("strokes::list").
inline std::string text_property(const Log& log, const char* name) {
  gchar* text = nullptr;
  gst_child_proxy_get(GST_CHILD_PROXY(log.object), name, &text, nullptr);
  std::string result = text ? text : "";
  g_free(text);
  return result;
}

/// What is wrong with a value of the text property `name`, which `read` reads, in words; else
/// empty.
template <typename Read>
std::string wrong_text(const GValue* value, const std::string& name, Read read) {
  const char* text = g_value_get_string(value);
  try {
    read(text ? text : "");
    return {};
  } catch (const Error& error) {
    return name + ": " + error.what();
  }
}

}  // namespace inverse
