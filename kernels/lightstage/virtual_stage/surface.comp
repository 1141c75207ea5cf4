// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/random.glsl"

// The head seen by a camera: position, normal and material of each sample.
PLANE_IN(0, scene);
PLANE_IN(1, materials);  // by turns albedo and roughness; reflectance along the normal, texture's strength and scale, 0
PLANE_OUT(2, position);  // xyz; w = 1 if there is something
PLANE_OUT(3, normal);    // xyz; w = roughness
PLANE_OUT(4, albedo);    // rgb; w = reflectance along the normal
layout(push_constant) uniform Push {
  uint width, height, primitives;
  float turn;      // of the camera about the vertical, radian
  float distance;  // of the camera from the axis
  float height_of_view;  // at the axis
  float center;          // of the view, above the origin
  uint first, count;     // pixels
} push;

#define SCENE(index) FETCH(scene, index)
#include "head.glsl"

const float kNear = 2.0, kStep = 0.7, kHit = 2e-4;  // steps are shorter than distances, which are of first order
const int kSteps = 160;
const float kEye = 3.0, kHair = 2.0;  // materials with a drawing of their own

// Smooth noise in [-1, 1] with random values at integer points.
float value_at(ivec3 cell) { return float(pcg3d(uvec3(cell)).x >> 8u) / 8388608.0 - 1.0; }
float noise(vec3 p) {
  vec3 start = floor(p), f = p - start;
  ivec3 cell = ivec3(start);
  f = f * f * (3.0 - 2.0 * f);
  float sum = 0.0;
  for (int i = 0; i < 8; ++i) {
    ivec3 corner = ivec3(i & 1, (i >> 1) & 1, i >> 2);
    vec3 weight = mix(1.0 - f, f, vec3(corner));
    sum += weight.x * weight.y * weight.z * value_at(cell + corner);
  }
  return sum;
}

// White of the eye, iris and pupil by the angle to the direction of gaze.
vec3 eye_color(vec3 out_of_center) {
  float across = length(out_of_center.xy);  // the eyes look along +z
  float iris = 1.0 - smoothstep(0.41, 0.47, across), pupil = 1.0 - smoothstep(0.17, 0.21, across);
  bool front = out_of_center.z > 0.0;
  vec3 color = mix(vec3(0.72, 0.68, 0.65), vec3(0.10, 0.16, 0.17), front ? iris : 0.0);
  return mix(color, vec3(0.01), front ? pupil : 0.0);
}

void main() {
  uint i = line_index();
  if (i >= push.count) return;
  i += push.first;
  uvec2 pixel = uvec2(i % push.width, i / push.width);
  float scale = push.height_of_view / float(push.height);
  vec2 plane = (vec2(pixel) + 0.5 - 0.5 * vec2(push.width, push.height)) * scale;
  vec3 forward = vec3(-sin(push.turn), 0.0, -cos(push.turn)), right = vec3(-forward.z, 0.0, forward.x);
  vec3 eye = vec3(0.0, push.center, 0.0) - push.distance * forward;
  vec3 ray = normalize(push.distance * forward + plane.x * right - plane.y * vec3(0.0, 1.0, 0.0));

  float t = push.distance - kNear, d = 1.0;
  for (int step = 0; step < kSteps && d > kHit && t < push.distance + kNear; ++step) {
    d = head_distance(eye + t * ray, push.primitives);
    t += kStep * d;
  }
  vec3 at = eye + t * ray;
  bool hit = t < push.distance + kNear && d < 20.0 * kHit;

  // The gradient, by differences at the corners of a tetrahedron.
  vec3 n = vec3(0.0);
  for (int k = 0; k < 4; ++k) {
    vec3 corner = vec3(((k + 3) >> 1) & 1, (k >> 1) & 1, k & 1) * 2.0 - 1.0;
    n += corner * head_distance(at + 1e-3 * corner, push.primitives);
  }
  n *= inversesqrt(max(dot(n, n), 1e-20));

  // The material of the nearest solid, or a blend if several are equally near.
  vec4 color = vec4(0.0);
  vec3 gloss = vec3(0.0);
  float all = 0.0;
  for (uint k = 0u; k < push.primitives; ++k) {
    Primitive e = primitive(k);
    float weight = e.kind == kCarving ? 0.0 : exp2(-400.0 * clamp(distance_to(e, at), 0.0, 0.25));
    int m = 2 * int(e.material);
    vec4 own = FETCH(materials, m), more = FETCH(materials, m + 1);
    vec3 out_of_center = to_ball(e, at - e.center);
    if (e.material == kEye) own.rgb = eye_color(out_of_center);
    // Hair strands run down from the crown.
    vec3 texture = e.material == kHair ? vec3(14.0 * at.x, 3.0 * at.y, 14.0 * at.z) : at * more.z;
    own.rgb *= 1.0 + more.y * (noise(texture) + 0.5 * noise(2.7 * texture) + 0.35 * noise(6.1 * texture));
    color += weight * own;
    gloss += weight * more.xyz;
    all += weight;
  }
  all = max(all, 1e-9);
  STORE(position, i, hit ? vec4(at, 1.0) : vec4(0.0));
  STORE(normal, i, hit ? vec4(n, color.w / all) : vec4(0.0, 0.0, 1.0, 1.0));
  STORE(albedo, i, hit ? vec4(max(color.rgb / all, 0.0), gloss.x / all) : vec4(0.0));
}
