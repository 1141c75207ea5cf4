// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <functional>

#include "stage/controllers/light_driver.hpp"

namespace inverse {

/// Hands a program to the lights, which may take minutes: whether they have it. What goes wrong is
/// an element error, unless it is that somebody has `given_up` and canceled the driver.
bool upload_program(GstElement* element, LightDriver& driver, const LightProgram& program,
                    const std::function<bool()>& given_up);

}  // namespace inverse
