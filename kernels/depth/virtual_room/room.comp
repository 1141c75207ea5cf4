// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/camera.glsl"

// What a camera sees in the room, and of a hand in it: reflectance and irradiance / pi of matte surfaces in white light, and depth. Colors
// are means of push.side² rays a pixel, depth is that of the pixel's center. The hand casts shadows of lamps, but takes no light from all
// around. One pixel an invocation.
//   S = sum over lamps of power V max(0, n·l) / d² + ambient · openness (open.comp)
PLANE_IN(0, scene);
SCALAR_IN(1, openness);
PLANE_IN(2, pose);
PLANE_OUT(3, layers);  // rgb: mean of R S; w: depth
PLANE_OUT(4, truth);   // rgb: mean of R; w: mean of S
PLANE_IN(5, hand);
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 size;
  uint side;
  uint solids;
  uint lamps;
  float ambient;
  uint parts;  // of the hand
} push;

#define SCENE(index) FETCH(scene, index)
#define HAND(index) FETCH(hand, index)
#include "room.glsl"
#include "hand.glsl"

const float kLift = 1e-3;  // meters, of rays off the surface

// The ambient light that reaches a place of a solid, 0…1.
float openness_at(uint i, Solid s, vec3 p) {
  vec3 side = p / s.half_size;
  int axis = axis_of(side);
  side /= abs(side[axis]);
  vec2 at = clamp((vec2(side[(axis + 1) % 3], side[(axis + 2) % 3]) * 0.5 + 0.5) * float(kOpenSide - 1), 0.0, float(kOpenSide) - 1.001);
  ivec2 first = ivec2(at);
  vec2 share = at - vec2(first);
  int index = open_index(i, axis, side[axis] > 0.0, first);
  vec4 around = vec4(FETCH1(openness, index), FETCH1(openness, index + 1), FETCH1(openness, index + kOpenSide), FETCH1(openness, index + kOpenSide + 1));
  return mix(mix(around.x, around.y, share.x), mix(around.z, around.w, share.x), share.y);
}

void main() {
  uint line = line_index();
  uvec2 pixel = uvec2(line % push.size.x, line / push.size.x);
  if (pixel.y >= push.size.y) return;
  vec4 rotation = FETCH(pose, 0), place = FETCH(pose, 1);
  vec3 sum = vec3(0.0), paint = vec3(0.0);
  float light = 0.0, depth = 0.0, count = float(push.side * push.side);
  for (uint n = 0u; n <= push.side * push.side; ++n) {
    // The last ray is the pixel's center.
    bool center = n == push.side * push.side;
    vec2 off = center ? vec2(0.0) : (vec2(n % push.side, n / push.side) + 0.5) / float(push.side) - 0.5;
    vec3 along = turned(rotation, ray_of(push.lens, vec2(pixel) + off));
    Hit hit = nearest_part(nearest(place.xyz, along), place.xyz, along);
    if (center) {
      depth = hit.along;
      break;
    }
    vec3 at = place.xyz + hit.along * along, normal, r;
    float shading;
    if (hit.solid < push.solids) {
      Solid s = solid_of(hit.solid);
      vec3 inside = into(s, at - s.center), in_axes = normal_in(s, inside);
      normal = out_of(s, in_axes);
      r = painted(hit.solid, s, inside, in_axes);
      shading = push.ambient * openness_at(hit.solid, s, inside);
    } else {
      normal = normal_of_part(hit.solid - push.solids, at);
      r = HAND(int(kHandStride * (hit.solid - push.solids)) + 2).rgb;
      shading = push.ambient * kHandOpen;
    }
    vec3 from = at + kLift * normal;
    for (uint l = 0u; l < push.lamps; ++l) {
      vec4 lamp = SCENE(int(kSolidStride * l + kLamp));
      vec3 to = lamp.xyz - from;
      float square = dot(to, to), cosine = dot(to, normal) * inversesqrt(square);
      shading += lamp.w * max(cosine, 0.0) / square * open(from, to, 1.0) * open_past_hand(from, to, 1.0);
    }
    sum += r * shading;
    paint += r;
    light += shading;
  }
  STORE(layers, line, vec4(sum / count, depth));
  STORE(truth, line, vec4(paint, light) / count);
}
