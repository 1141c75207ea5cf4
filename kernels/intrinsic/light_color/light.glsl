// SPDX-License-Identifier: LGPL-2.1-or-later
// The color of the scene's light (image/light_color.glsl), from frame to frame.
#include "image/light_color.glsl"

// Of the scene, vec4s:
#define LIGHT_NOW 0  // k; m at which the guide takes light as white; confidence of k, 0...1; 1 once a frame was measured
#define LIGHT_SIZE 1

// Points of the frame, cells of LIGHT_POINTS at most along its longer side, a vec4 each: m; b = ln R/B; g = ln sqrt(R B)/G; weight.
#define LIGHT_POINTS 80
