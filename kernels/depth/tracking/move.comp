// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "camera/camera.glsl"
#include "align.glsl"
#include "tracking.glsl"

// Solves the normal equations of align.comp and moves the pose; after the last step, decides whether it is found, and else goes back to
// where it started. One workgroup.
PLANE_IN(0, sums);
PLANE_IN(1, start);   // the pose before the first step
PLANE_INOUT(2, pose);
PLANE_INOUT(3, found);
PLANE_IN(4, agreement);  // agree.comp, if the camera was lost
WORD_INOUT(5, lost);     // 1 if it was in the frame before, and then if it is
layout(push_constant) uniform Push {
  uint groups;      // of align.comp
  float damping;    // added to the diagonal, as a share of the sum of weights (per m² and rad²)
  uint last;        // whether to decide
  float min_share;  // of pixels with a depth that must match, ...
  float lost_share; // ... and if the camera was lost in the frame before
  float max_rms;    // meters
  float min_alike;  // correlation with the view that one that was lost needs, ...
  float plain;      // ... unless steps of the frame's ln brightness are smaller
} push;

float a[kUnknowns * (kUnknowns + 1)];  // rows of the upper triangle, then what the equations equal

void main() {
  vec4 total[kSums];
  for (uint k = 0u; k < kSums; ++k) {
    vec4 sum = vec4(0.0);
    for (uint g = gl_LocalInvocationIndex; g < push.groups; g += gl_WorkGroupSize.x) sum += FETCH(sums, int(g * kSums + k));
    total[k] = workgroup_sum(sum);
  }
  if (gl_LocalInvocationIndex != 0u) return;
  float weights = total[7].x;
  // a[7 i + j]: row i, column j; column 6 is the right-hand side.
  int n = 0;
  for (int i = 0; i < kUnknowns; ++i)
    for (int j = i; j < kUnknowns; ++j, ++n) a[7 * i + j] = total[n >> 2][n & 3];
  for (int i = 0; i < kUnknowns; ++i, ++n) a[7 * i + 6] = total[n >> 2][n & 3];
  float smallest = 1e30;
  bool solved = weights > 0.0;
  for (int i = 0; i < kUnknowns; ++i) {
    a[7 * i + i] += push.damping * weights;
    // Gauss, on the upper triangle alone.
    float pivot = a[7 * i + i];
    smallest = min(smallest, pivot / max(weights, 1e-20));
    solved = solved && pivot > 1e-9 * weights;
    for (int r = i + 1; r < kUnknowns; ++r) {
      float factor = a[7 * i + r] / pivot;
      for (int c = r; c < 7; ++c) a[7 * r + c] -= factor * a[7 * i + c];
    }
  }
  float x[kUnknowns];
  for (int i = kUnknowns - 1; i >= 0; --i) {
    float sum = a[7 * i + 6];
    for (int c = i + 1; c < kUnknowns; ++c) sum -= a[7 * i + c] * x[c];
    x[i] = sum / a[7 * i + i];
  }
  vec3 turn = vec3(x[0], x[1], x[2]), shift = vec3(x[3], x[4], x[5]);
  float angle = length(turn);
  solved = solved && angle < 0.5 && dot(shift, shift) < 1.0;  // not for NaN
  if (solved) {
    vec4 by = vec4(angle > 1e-6 ? sin(0.5 * angle) / angle * turn : 0.5 * turn, cos(0.5 * angle));
    STORE(pose, 0u, normalize(product(by, LOAD(pose, 0u))));
    STORE(pose, 1u, LOAD(pose, 1u) + vec4(shift, 0.0));
  }
  if (push.last == 0u) return;
  float rms = sqrt(total[6].w / max(weights, 1e-20)), share = total[7].y / max(total[7].z, 1.0);
  vec4 before = LOAD(found, kFound);
  bool was_lost = LOAD(lost, 0) != 0u;
  bool good = solved && share >= (was_lost ? push.lost_share : push.min_share) && rms <= push.max_rms;
  vec4 alike = FETCH(agreement, 0);
  good = good && !(was_lost && alike.y > push.plain && alike.x < push.min_alike);
  STORE(found, kAlike, alike);
  STORE(found, kFound, good ? vec4(1.0, 0.0, before.z + 1.0, 0.0) : vec4(0.0, before.y + 1.0, 0.0, 0.0));
  STORE(lost, 0, good ? 0u : 1u);
  STORE(found, kFit, vec4(rms, share, total[7].w / max(total[7].z, 1.0), smallest));
  STORE(found, kMotion, vec4(shift, angle));
  if (good) return;
  STORE(pose, 0u, FETCH(start, 0));
  STORE(pose, 1u, FETCH(start, 1));
}
