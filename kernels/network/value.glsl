// SPDX-License-Identifier: LGPL-2.1-or-later
// A value: channels in blocks of four, one vec4 per pixel, block by block, row by row, after one vec4 of zeros. Pixels
// outside of the image read that zero, so that a border costs one max of an index.
#include "gpu/common.glsl"

layout(constant_id = 1) const uint kActivation = 0u;  // network::Activation

vec4 activated(vec4 v, float slope) {
  if (kActivation == 1u) return max(v, 0.0);
  if (kActivation == 2u) return max(v, 0.0) + slope * min(v, 0.0);
  if (kActivation == 4u) return clamp(v, 0.0, 6.0);
  if (kActivation == 3u) return 1.0 / (1.0 + exp(-v));
  return v;
}
