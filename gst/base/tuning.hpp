// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <string>
#include <utility>
#include <vector>

namespace inverse {

/// The values that a property takes, and its default: "0…1 (0.5)".
std::string values_of(GParamSpec* spec);

/// The text of a `tuning` property, "name=value:name=value" (or with ','), as pairs in order.
/// Throws Error(unsupported) if it is something else.
std::vector<std::pair<std::string, std::string>> tuning_entries(const std::string& text);

/// Reads `text` as a value of the property `spec` into `value`, which is unset. Throws
/// Error(unsupported) if it is none, or out of range.
void tuning_value(GParamSpec* spec, const std::string& text, GValue* value);

}  // namespace inverse
