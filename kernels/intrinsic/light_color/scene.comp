// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "light.glsl"

// Statistics of the points: m of the brightest, whether the scene is a new one, whether k can be measured at all. Decides whether it
// is measured in this frame: writes the workgroup counts of the kernels that do so, 0 to skip them. One workgroup.
PLANE_IN(0, points);      // wide (light.glsl)
PLANE_INOUT(1, light);
SCALAR_INOUT(2, cloud);   // shares of points; on entry of the frame before
WORD_OUT(3, arguments);   // three words for each of the kernels that measure
layout(push_constant) uniform Push {
  uint count;         // points
  uint first;         // 1: there is no frame before
  uint due;           // 1: measure k; 0: only in a new scene
  uint automatic;     // 0: k is given
  float slope;        // then
  uint groups[5];     // workgroups of the kernels that measure, but for MEASURE_DECIDE, which has one
} push;

const uint kBins = 256u;
const float kLow = -6.4, kHigh = 1.6;           // m of the first and last bin
const float kBright = 0.95;                     // quantile of m
const float kBrightStep = 0.4, kColorStep = 0.1;  // bins of the cloud
const float kCut = 0.5;                         // share of the points that are elsewhere in the cloud
const float kNoColor = 0.02, kColor = 0.05;     // spread of (b, g), from none to full effect of k
const float kNoContrast = 0.05;                 // spread of m

shared uint counts[kBins + uint(CLOUD_COUNT)];

uint bin_of(float m) { return uint(clamp((m - kLow) * (float(kBins) / (kHigh - kLow)), 0.0, float(kBins - 1u))); }

void main() {
  uint lane = gl_LocalInvocationID.x, lanes = gl_WorkGroupSize.x;
  for (uint i = lane; i < kBins + uint(CLOUD_COUNT); i += lanes) counts[i] = 0u;
  barrier();
  vec4 sum = vec4(0.0), squares = vec4(0.0);
  for (uint i = lane; i < push.count; i += lanes) {
    vec4 point = FETCH(points, int(i));
    sum += point.w * vec4(point.xyz, 1.0);
    squares += point.w * vec4(point.xyz * point.xyz, 0.0);
    atomicAdd(counts[bin_of(point.x)], 1u);
  }
  sum = workgroup_sum(sum);
  squares = workgroup_sum(squares);
  vec3 mean = sum.xyz / max(sum.w, 1e-6), variance = max(squares.xyz / max(sum.w, 1e-6) - mean * mean, vec3(0.0));
  barrier();
  uint above = uint((1.0 - kBright) * float(push.count)), bin = kBins - 1u;
  for (uint over = counts[bin]; over <= above && bin > 0u; over += counts[bin]) --bin;
  float bright = kLow + (float(bin) + 0.5) * ((kHigh - kLow) / float(kBins));
  for (uint i = lane; i < push.count; i += lanes) {
    vec4 point = FETCH(points, int(i));
    uint row = uint(clamp((bright - point.x) / kBrightStep, 0.0, float(CLOUD_LEVELS - 1)));
    float place = clamp(point.y / kColorStep + float(CLOUD_COLORS / 2), 0.0, float(CLOUD_COLORS - 1) - 0.001);
    uint at = kBins + row * uint(CLOUD_COLORS) + uint(place), share = uint(256.0 * fract(place) + 0.5);
    atomicAdd(counts[at], 256u - share);
    atomicAdd(counts[at + 1u], share);
  }
  barrier();
  vec4 change = vec4(0.0);
  for (uint i = lane; i < uint(CLOUD_COUNT); i += lanes) {
    float now = float(counts[kBins + i]) / (256.0 * float(push.count));
    change.x += abs(now - LOAD(cloud, i));
    STORE(cloud, i, now);
  }
  change = workgroup_sum(change);
  if (lane > 0u) return;

  vec4 target = LOAD(light, LIGHT_TARGET);
  bool known = push.first == 0u && LOAD(light, LIGHT_NOW).w > 0.0, cut = !known || !(0.5 * change.x < kCut);
  float usable = smoothstep(kNoColor, kColor, sqrt(variance.y + variance.z));
  uint did = usable == 0.0 ? LIGHT_NO_COLOR : variance.x < kNoContrast * kNoContrast ? LIGHT_NO_CONTRAST : LIGHT_MEASURED;
  if (push.automatic == 0u) {
    usable = 1.0;
    target = vec4(push.slope, 0.0, 0.0, 0.0);
    did = LIGHT_REUSED;
  } else {
    if (cut) target = vec4(0.0);
    if (did == LIGHT_MEASURED && target.z > 0.0 && push.due == 0u) did = LIGHT_REUSED;
  }
  vec4 before = LOAD(light, LIGHT_FRAME);
  bool new_slope = push.automatic == 0u || (target.z == 0.0 && did == LIGHT_MEASURED);
  float jump = cut ? LIGHT_NEW_SCENE : new_slope ? LIGHT_NEW_SLOPE : LIGHT_FOLLOW;
  STORE(light, LIGHT_FRAME, vec4(usable, bright, max(jump, before.z), before.w));
  target.w = float(did);
  STORE(light, LIGHT_TARGET, target);
  uint measures = did == uint(LIGHT_MEASURED) ? 1u : 0u;
  for (uint k = 0u; k < uint(MEASURE_KERNELS); ++k) {
    STORE(arguments, 3u * k, k == uint(MEASURE_DECIDE) ? measures : measures * push.groups[k]);
    STORE(arguments, 3u * k + 1u, 1u);
    STORE(arguments, 3u * k + 2u, 1u);
  }
}
