// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <functional>

#include "kernels/lightstage/controllers/light_driver.hpp"

namespace inverse {

/// Sends a program to the lights, which may take minutes; true on success. Errors become element
/// errors, unless `given_up` and the driver was canceled.
bool upload_program(GstElement* element, LightDriver& driver, const LightProgram& program,
                    const std::function<bool()>& given_up);

}  // namespace inverse
