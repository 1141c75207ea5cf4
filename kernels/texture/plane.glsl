// SPDX-License-Identifier: LGPL-2.1-or-later
// Shared by the kernels of a plane: homographies, and values between pixels.
#include "edit/edit.glsl"

// The point of the homography with these rows; its third coordinate before division is `depth`.
vec2 mapped(vec4 rows[3], vec2 point, out float depth) {
  vec3 p = vec3(point, 1.0);
  depth = dot(rows[2].xyz, p);
  return vec2(dot(rows[0].xyz, p), dot(rows[1].xyz, p)) / depth;
}

// Where a continuous position lies between the centers of `size` pixels: the pixel before it, and the share of the next.
struct Between {
  ivec2 low, high;
  vec2 share;
};
Between between(vec2 at, uvec2 size) {
  vec2 last = vec2(size) - 1.0;
  vec2 center = clamp(at - 0.5, vec2(0.0), last);
  Between b;
  b.low = ivec2(center);
  b.high = min(b.low + 1, ivec2(last));
  b.share = center - vec2(b.low);
  return b;
}
#define BILINEAR(read, b, width)                                                                        \
  mix(mix(read(b.low.y * width + b.low.x), read(b.low.y * width + b.high.x), b.share.x),               \
      mix(read(b.high.y * width + b.low.x), read(b.high.y * width + b.high.x), b.share.x), b.share.y)
