// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"

PLANE_IN(4, nodes);

int rows() { return push.size.y; }
vec4 diagonal_at(int n) { return diagonal(FETCH(nodes, n)); }

#include "thesis/shared/update.glsl"
