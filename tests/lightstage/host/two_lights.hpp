// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/lightstage/program/light_program.hpp"
#include "tests/expect_error.hpp"

namespace inverse::testing {

/// Two lights in two universes, all kinds of steps.
inline LightProgram two_lights() {
  LightProgram program;
  program.name = "two lights";
  program.lights = {{{0.6, 0, 0.8}, {1, 2, 3}}, {{0, 1, 0}, {513, 514, 515}}};
  program.steps = {{StepKind::olat, 1},
                   {StepKind::gradient_a},
                   {StepKind::gradient_b},
                   {StepKind::tracking},
                   {StepKind::custom, 0, {{1, .5F, 0}, {0, 0, .25F}}}};
  program.marker = LightProgram::Marker::start;
  program.repeat = 2;
  program.check();
  return program;
}

}  // namespace inverse::testing
