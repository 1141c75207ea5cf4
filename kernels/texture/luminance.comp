// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/finite.glsl"

// The luminance of a frame at reduced size, for the host: Y^(1/2.2) of the mean linear light of FACTOR x FACTOR pixels, in
// which noise and contrast are about as even as in video.
layout(constant_id = 1) const uint FACTOR = 1u;

PLANE_IN(0, frame);        // linear RGB
SCALAR_OUT(1, luminance);  // 0…1
layout(push_constant) uniform Push {
  uvec2 frame_size, size;  // size = ceil(frame_size / FACTOR)
} push;

void main() {
  uint n = line_index();
  if (n >= push.size.x * push.size.y) return;
  uvec2 first = uvec2(n % push.size.x, n / push.size.x) * FACTOR;
  uvec2 end = min(first + FACTOR, push.frame_size);
  float sum = 0.0;
  for (uint y = first.y; y < end.y; ++y)
    for (uint x = first.x; x < end.x; ++x)
      sum += min(dot(finite(FETCH(frame, int(y * push.frame_size.x + x))).rgb, vec3(0.2126, 0.7152, 0.0722)), 1.0);
  uvec2 count = end - first;
  float mean = sum / float(count.x * count.y);
  STORE(luminance, n, mean > 0.0 ? exp(log(mean) * (1.0 / 2.2)) : 0.0);
}
