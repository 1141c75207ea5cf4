// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include "gst/inverse/inverse_light_stage_meta.h"
#include "kernels/lightstage/program/light_program.hpp"

namespace inverse {

/// Adds a light stage meta to a buffer: all zero, step and light -1.
GstLightStageMeta* add_light_stage_meta(GstBuffer* buffer);

/// Writes what a program does at a trigger into a meta: pass, step, kind, light and its direction.
void set_position(GstLightStageMeta* meta, const LightProgram& program,
                  const LightProgram::Position& at);

/// Registers the meta, so that its header works before the first frame.
void register_light_stage_meta();

}  // namespace inverse
