// SPDX-License-Identifier: LGPL-2.1-or-later
// Inputs and outputs of the networks of thesis chapter 6. Colors are sRGB 0…1; the specular layer and the mirror image
// are linear with high dynamic range, coded as ln(1 + 4 x) / 2 (training/lime/README.md).
#include "gpu/common.glsl"

const float kObject = 0.5;  // probability from which on a point is of the object

float decode(float code) { return 0.25 * (exp(2.0 * clamp(code, 0.0, 8.0)) - 1.0); }

// Linear light above which a camera may have clipped, and has clipped.
const vec2 kClips = vec2(0.85, 0.98);

// Linear light as a guide of the mask: perceptually about as uniform as sRGB, and cheaper.
vec3 guide_of(vec3 rgb) { return sqrt(max(rgb, vec3(0.0))); }
