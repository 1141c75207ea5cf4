// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

#include "filter.hpp"

namespace inverse {

/// A warning if a picture that comes into an element which takes frames is marked as that of a
/// layer (ViewMark), and what to do; else empty.
std::string misplaced_view(GstElement* element, const Filter& filter, GstBuffer* in);

/// Marks a picture that goes out if it shows a layer: by the element's property `show`.
void mark_shown(GstElement* element, const Filter& filter, GstBuffer* out);

}  // namespace inverse
