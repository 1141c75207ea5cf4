// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// The head under one distant white light after another, each of irradiance pi: linear RGB as half floats.
//   L = (albedo + pi f_s) V (n·l),  f_s = D G F / (4 n·l n·v) with GGX, Smith and Schlick
//   V = product over solids of 1 - smoothstep(-1, 1, (1 - q) r / (penumbra t + start))
// for a ray to the light that passes a solid of smallest radius r at distance q from its center, in units of its ball,
// after the distance t. A point inside of a solid (blends extend beyond solids, carvings into them) is not in that
// solid's shadow.
PLANE_IN(0, scene);
PLANE_IN(1, position);
PLANE_IN(2, normal);
PLANE_IN(3, albedo);
PLANE_IN(4, lights);  // xyz: direction
WORD_OUT(5, olats);   // two a pixel, image after image
layout(push_constant) uniform Push {
  uint width, height;  // of an image
  uint side;           // samples of the surface along each side of a pixel
  uint first, count;   // lights
  uint target;         // place of the first one's image
  uint primitives;
  float eye_x, eye_y, eye_z;
} push;

#define SCENE(index) FETCH(scene, index)
#include "head.glsl"

const float kPi = 3.14159265358979;
const float kPenumbra = 0.035, kStart = 0.004;

float visible(vec3 at, vec3 to_light, uint primitives) {
  float open = 1.0;
  for (uint i = 0u; i < primitives; ++i) {
    Primitive e = primitive(i);
    vec3 q = to_ball(e, at - e.center), l = to_ball(e, to_light);
    float t = -dot(q, l) / dot(l, l);
    float over = (1.0 - length(q + max(t, 0.0) * l)) * e.radius / (kPenumbra * max(t, 0.0) + kStart);
    bool shades = e.kind != kCarving && t > 0.0 && dot(q, q) > 1.0;
    open *= shades ? 1.0 - smoothstep(-1.0, 1.0, over) : 1.0;
  }
  return open;
}

vec3 lit(uint i, vec3 l) {
  vec4 p = FETCH(position, int(i)), turned = FETCH(normal, int(i)), color = FETCH(albedo, int(i));
  vec3 n = turned.xyz, v = normalize(vec3(push.eye_x, push.eye_y, push.eye_z) - p.xyz);
  vec3 h = normalize(l + v);
  float nl = dot(n, l), nv = max(dot(n, v), 1e-3), nh = max(dot(n, h), 0.0), vh = max(dot(v, h), 0.0);
  float cosine = max(nl, 1e-4);
  float a = turned.w * turned.w, a2 = a * a;
  float around = nh * nh * (a2 - 1.0) + 1.0;
  float distribution = a2 / (kPi * around * around);
  // Smith's G divided by 4 n·l n·v.
  float mask = 0.5 / (cosine * sqrt(a2 + (1.0 - a2) * nv * nv) + nv * sqrt(a2 + (1.0 - a2) * cosine * cosine));
  float fresnel = color.w + (1.0 - color.w) * pow(1.0 - vh, 5.0);
  vec3 value = (color.rgb + kPi * distribution * mask * fresnel) * cosine;
  bool faces = p.w > 0.0 && nl > 0.0;
  float open = visible(p.xyz, l, faces ? push.primitives : 0u);  // loops are what a device leaves out
  return faces ? value * open : vec3(0.0);
}

void main() {
  uint pixels = push.width * push.height;
  uint i = gl_GlobalInvocationID.x, light = gl_GlobalInvocationID.y;
  if (i >= pixels || light >= push.count) return;
  vec3 l = FETCH(lights, int(push.first + light)).xyz;
  uvec2 pixel = uvec2(i % push.width, i / push.width) * push.side;
  vec3 sum = vec3(0.0);
  for (uint s = 0u; s < push.side * push.side; ++s) {
    uvec2 sample_at = pixel + uvec2(s % push.side, s / push.side);
    sum += lit(sample_at.y * push.width * push.side + sample_at.x, l);
  }
  sum = min(sum / float(push.side * push.side), 65504.0);
  uint at = 2u * ((push.target + light) * pixels + i);
  STORE(olats, at, packHalf2x16(sum.xy));
  STORE(olats, at + 1u, packHalf2x16(vec2(sum.z, 0.0)));
}
