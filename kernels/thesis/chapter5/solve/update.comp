// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "thesis/chapter5/energy/terms.glsl"

PLANE_IN(4, diagonals);

// All planes of the field are one tall image here.
int rows() { return push.size.y * (kGroups + 1); }
vec4 diagonal_at(int n) { return FETCH(diagonals, n); }

#include "thesis/shared/update.glsl"
