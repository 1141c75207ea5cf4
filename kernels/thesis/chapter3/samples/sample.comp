// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "samples.glsl"

// The source terms of an IRLS step: the constant ones, and samples from the current frame.
PLANE_IN(7, constant_sources);

const int kSampled = kCurrent;
vec4 other_sources(int n) { return FETCH(constant_sources, n); }

#include "thesis/shared/sample.glsl"
