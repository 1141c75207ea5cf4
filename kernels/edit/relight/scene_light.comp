// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "edit/edit.glsl"
#include "camera/camera.glsl"
#include "camera/known_surface.glsl"
#include "camera/jump.glsl"
#include "relight.glsl"

// Light of lamps in a remembered scene on what a frame sees of it. One pixel of the view an invocation.
//
//   E = sum over lamps of light_of(lamp) · share(lamp)
//
// Shares and normals are bilinear between those pixels around it that have them (scene_shadows.comp) and are of the same surface;
// where none is, between all that are known.
PLANE_IN(0, lamps);    // as place.comp leaves them
PLANE_IN(1, surface);  // SeenScene
PLANE_IN(2, pose);
PLANE_IN(3, normals);  // scene_shadows.comp
WORD_IN(4, shares);
PLANE_OUT(5, light);   // rgb; w: depth, meters, 0: nothing is known
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 size;
  int first, count;  // lamps
} push;
#include "lamp_light.glsl"

const float kOther = 1e-6;  // weight of other surfaces

void main() {
  uint line = line_index();
  uvec2 pixel = uvec2(line % push.size.x, line / push.size.x);
  if (pixel.y >= push.size.y) return;
  vec4 seen = known_surface(FETCH(surface, int(line))), rotation = FETCH(pose, 0);
  vec3 sum = vec3(0.0);
  if (seen.w > 0.0) {
    uvec2 grid = (push.size + kShareStep - 1u) / kShareStep, low = pixel / kShareStep;
    vec2 part = vec2(pixel - kShareStep * low) / float(kShareStep);
    vec3 place = to_world(rotation, FETCH(pose, 1), seen.w * ray_of(push.lens, vec2(pixel)));
    vec3 rough = turned(rotation, seen.xyz), normal = vec3(0.0);
    vec4 total_shares[2] = vec4[](vec4(0.0), vec4(0.0));
    float total = 0.0;
    for (uint i = 0u; i < 4u; ++i) {
      uvec2 at = min(low + uvec2(i & 1u, i >> 1), grid - 1u);
      int n = int(at.y * grid.x + at.x);
      vec4 other = FETCH(normals, n);
      bool alike = dot(other.xyz, rough) > kAlike, same = alike && abs(other.w - seen.w) <= kJump * seen.w;
      vec2 near = mix(1.0 - part, part, vec2(i & 1u, i >> 1));
      float weight = other.w > 0.0 ? near.x * near.y * (same ? 1.0 : kOther) : 0.0;
      normal += weight * (same ? other.xyz : rough);
      total_shares[0] += weight * unpackUnorm4x8(FETCH1(shares, int(kShareWords) * n));
      total_shares[1] += weight * unpackUnorm4x8(FETCH1(shares, int(kShareWords) * n + 1));
      total += weight;
    }
    bool any = total > 0.0;
    normal = any ? normalize(normal) : rough;
    for (int k = 0; k < push.count; ++k)
      sum += light_of(push.first + k, place, normal) * (any ? total_shares[k >> 2][k & 3] / total : 1.0);
  }
  STORE(light, line, vec4(min(sum, vec3(kLargest)), seen.w));
}
