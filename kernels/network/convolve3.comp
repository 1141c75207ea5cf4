// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "value.glsl"

// A 3 x 3 convolution.
#define ROWS 8
#define STRIDE 1
#include "convolve3.glsl"
