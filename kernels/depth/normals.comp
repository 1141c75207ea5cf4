// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/camera.glsl"
#include "camera/jump.glsl"

// Normals of a depth image, from differences between neighbors on both sides, or on one where the other is off the surface. One pixel
// an invocation.
SCALAR_IN(0, depth);   // meters along the optical axis; 0: unknown
PLANE_OUT(1, surface); // xyz: unit normal toward the camera, 0: unknown; w: depth
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 size;
} push;

// Beyond the border, that of the pixel there.
vec3 point(ivec2 pixel) {
  pixel = clamp(pixel, ivec2(0), ivec2(push.size) - 1);
  return FETCH1(depth, pixel.y * int(push.size.x) + pixel.x) * ray_of(push.lens, vec2(pixel));
}
vec3 difference(vec3 at, ivec2 pixel, ivec2 step) {
  vec3 low = point(pixel - step), high = point(pixel + step);
  bool before = low.z > 0.0 && abs(low.z - at.z) < kJump * at.z, after = high.z > 0.0 && abs(high.z - at.z) < kJump * at.z;
  return (after ? high : at) - (before ? low : at);  // 0 if neither
}

void main() {
  uint line = line_index();
  ivec2 pixel = ivec2(line % push.size.x, line / push.size.x);
  if (pixel.y >= int(push.size.y)) return;
  vec3 at = point(pixel);
  vec3 normal = cross(difference(at, pixel, ivec2(0, 1)), difference(at, pixel, ivec2(1, 0)));
  float square = dot(normal, normal);
  bool known = at.z > 0.0 && square > 0.0;
  STORE(surface, line, vec4(known ? normal * inversesqrt(square) : vec3(0.0), at.z));
}
