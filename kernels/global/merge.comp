#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "../image/workgroup_sum.glsl"
#include "model.glsl"

// One workgroup: base colors that hardly ever see direct light, and that are near enough to another that does, given the
// tint that such light has, are that other color in the shade. Takes the place of the thesis' click (section 5.5.2).
PLANE_IN(0, points);
PLANE_IN(1, tints);
PLANE_INOUT(2, scene);
layout(set = 0, binding = 3, std430) coherent restrict buffer slots_block { uint slots_data[]; };
layout(push_constant) uniform Push {
  int count;       // of points
  float shaded;    // mean indirect fraction from which on a color may be another's shade
  float reach;     // times the tint that such light has: how far away the other may be
  float farthest;  // and at most
} push;

shared uint into[kSlots];

void main() {
  vec4 mass[kSlots / 4], shade[kSlots / 4];
  for (int q = 0; q < kSlots / 4; ++q) mass[q] = shade[q] = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < push.count; i += int(gl_WorkGroupSize.x)) {
    vec4 tint = FETCH(tints, i);
    int slot = int(LOAD(slots, bin_of(FETCH(points, i).xy - tint.xy)));
    for (int q = 0; q < kSlots / 4; ++q) {
      vec4 here = tint.w * vec4(equal(ivec4(4 * q) + ivec4(0, 1, 2, 3), ivec4(slot)));
      mass[q] += here;
      shade[q] += here * tint.z;
    }
  }
  for (int q = 0; q < kSlots / 4; ++q) {
    mass[q] = workgroup_sum(mass[q]) + 1e-9;
    shade[q] = workgroup_sum(shade[q]) / mass[q];
  }
  if (gl_LocalInvocationID.x == 0u) {
    float full = LOAD(scene, SCENE_TINT).x;
    for (int k = 0; k < kSlots; ++k) into[k] = uint(k);
    uint done = 0u;
    for (int turn = 0; turn < kSlots; ++turn) {
      int j = -1;  // the most shaded one that is left
      for (int k = 0; k < kSlots; ++k)
        if ((done & (1u << k)) == 0u && LOAD(scene, SCENE_COLORS + k).z > 0.0 &&
            (j < 0 || shade[k / 4][k % 4] > shade[j / 4][j % 4]))
          j = k;
      if (j < 0) break;
      done |= 1u << j;
      float own = shade[j / 4][j % 4];
      if (own <= push.shaded) break;
      vec4 color = LOAD(scene, SCENE_COLORS + j);
      float nearest = min(push.reach * full * own, push.farthest);
      nearest *= nearest;
      int to = -1;
      for (int k = 0; k < kSlots; ++k) {
        vec4 other = LOAD(scene, SCENE_COLORS + k);
        vec2 off = other.xy - color.xy;
        if (k == j || other.z == 0.0 || shade[k / 4][k % 4] > own || dot(off, off) >= nearest) continue;
        nearest = dot(off, off);
        to = k;
      }
      if (to < 0) continue;
      vec4 other = LOAD(scene, SCENE_COLORS + to);
      float a = mass[to / 4][to % 4], b = mass[j / 4][j % 4];
      LOAD(scene, SCENE_COLORS + to) = vec4((a * other.xy + b * color.xy) / (a + b), 1.0, other.w + color.w);
      LOAD(scene, SCENE_COLORS + j) = vec4(0.0);
      mass[to / 4][to % 4] = a + b;
      for (int k = 0; k < kSlots; ++k)
        if (into[k] == uint(j)) into[k] = uint(to);
      LOAD(scene, SCENE_AMOUNT).w -= 1.0;
    }
  }
  barrier();
  for (int b = int(gl_LocalInvocationID.x); b < kBinCount; b += int(gl_WorkGroupSize.x))
    LOAD(slots, b) = into[LOAD(slots, b)];
}
