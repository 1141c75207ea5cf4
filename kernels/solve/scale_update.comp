// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "solve/scale.glsl"

// The scale of a frame: about the median of the offsets that keep the points' reflectance; at a start or a cut the scale of the frame
// alone. One workgroup.
PLANE_IN(0, samples);
PLANE_IN(1, points);
PLANE_IN(2, target);    // .x: offset that the frame alone would get, .y: 0 if all of it is dark, .z: light of what is brightest, ln
PLANE_IN(3, decision);  // .y = 0 at a cut
PLANE_INOUT(4, scale);
PLANE_IN(5, light);     // as scale_track.comp has it
layout(push_constant) uniform Push {
  uvec2 size;       // of the cells
  uint count;       // 0: none were followed
  float log_white;  // ln of the white level
  uint history;     // 0: no frame before; 1: one, on which `decision` decides; 2: one without a decision
} push;

const int kRounds = 10;
const float kWidth = 0.02;        // log units from the center; samples farther away count as in a median (pseudo-Huber)
const float kNoZoom = 0.1;        // weight of no zoom and no turn, squared log units
const float kMinFound = 0.05;       // share of the points that must be found again
const float kSameScene = 0.5;     // share of the points' texture that is found again at no cut
const float kFollow = 0.1;        // share of the frame's own offset if fewer are
const float kMoreLight = 0.25;    // growth of the bright share from which the frame's own offset counts
const float kMeanRate = 1.0 / 64.0;  // share of the newest frame in the mean bright share

void main() {
  uint lane = gl_LocalInvocationID.x, lanes = gl_WorkGroupSize.x;
  vec4 now = LOAD(scale, SCALE_NOW), motion = LOAD(scale, SCALE_MOTION), state = LOAD(scale, SCALE_STATE);
  vec3 goal = FETCH(target, 0).xyz;
  vec2 center = 0.5 * vec2(push.size) - 0.5;

  vec4 shares = vec4(0.0);  // of points: bright, found again; of their texture: found again, all
  for (uint i = lane; i < push.count; i += lanes) {
    vec4 sample_offset = FETCH(samples, int(SAMPLE_STRIDE * i) + SAMPLE_OFFSET);
    float is_found = FETCH(samples, int(SAMPLE_STRIDE * i) + SAMPLE_MOTION).z > 0.0 ? 1.0 : 0.0;
    shares += vec4(sample_offset.w, is_found, is_found * sample_offset.z, sample_offset.z);
  }
  shares = workgroup_sum(shares);
  float bright = shares.x / max(float(push.count), 1.0), found = shares.y / max(float(push.count), 1.0);
  // A change of light's color alone may pass for a cut; its points are found again.
  bool cut = push.history == 1u && !(FETCH(decision, 0).y > 0.0) && !(shares.z > kSameScene * shares.w);
  bool known = push.history > 0u && !cut && now.y > 0.0;

  vec2 center_of = vec2(now.z, LOAD(scale, SCALE_LIGHT).x);  // offset, exposure
  for (int round = 0; round < kRounds; ++round) {
    vec4 sum = vec4(0.0);
    vec4 means = vec4(0.0), squares = vec4(0.0);
    for (uint i = lane; i < push.count; i += lanes) {
      vec4 sample_offset = FETCH(samples, int(SAMPLE_STRIDE * i) + SAMPLE_OFFSET);
      vec4 sample_motion = FETCH(samples, int(SAMPLE_STRIDE * i) + SAMPLE_MOTION);
      if (!(sample_motion.z > 0.0)) continue;
      vec2 value = vec2(sample_offset.x, sample_motion.w), away = (value - center_of) / kWidth;
      vec2 weight = sample_offset.y * vec2(1.0, sample_motion.z) * inversesqrt(1.0 + away * away);
      sum += vec4(weight * value, weight);
      vec2 moved = sample_motion.xy, from = FETCH(points, int(i)).xy - moved - center;
      vec2 apart = moved - common_motion(motion, from);
      float steady = sample_offset.z / (1.0 + dot(apart, apart));
      means += steady * vec4(moved, from);
      squares += steady * vec4(dot(from, from), dot(from, moved), from.x * moved.y - from.y * moved.x, 1.0);
    }
    sum = workgroup_sum(sum);
    means = workgroup_sum(means);
    squares = workgroup_sum(squares);
    if (min(sum.z, sum.w) > 1e-6) center_of = sum.xy / sum.zw;
    if (squares.w > 1e-6) {  // the similarity of least squares
      means /= squares.w;
      vec2 products = squares.yz - squares.w * vec2(dot(means.zw, means.xy), means.z * means.y - means.w * means.x);
      motion.zw = products / (squares.x - squares.w * dot(means.zw, means.zw) + kNoZoom * dot(center, center));
      motion.xy = means.xy - common_motion(vec4(0.0, 0.0, motion.zw), means.zw);
    }
  }
  if (lane > 0u) return;
  float before = state.y, offset = center_of.x, exposure = LOAD(scale, SCALE_LIGHT).x;

  bool tracked = known && found > kMinFound;
  float shift = 0.0, brighter = tracked && goal.y > 0.0 ? center_of.y - exposure : 0.0;
  float white = state.w + brighter;
  STORE(scale, SCALE_LIGHT, vec4(exposure + brighter, FETCH(light, 0).xy, brighter));

  // A dark frame changes nothing; if no scale is known, the solver's own stays.
  if (goal.y == 0.0) {
    STORE(scale, SCALE_NOW, known ? vec4(push.log_white + now.z, now.yz, now.z) : vec4(0.0));
    STORE(scale, SCALE_MOTION, vec4(0.0));
    STORE(scale, SCALE_STATE, vec4(0.0, before, 0.0, known ? state.w : 0.0));
    return;
  }
  if (!known) {
    offset = goal.x;
    white = goal.z - offset;
  } else if (push.count == 0u) {
    offset = now.z;
  } else if (!tracked) {
    offset = mix(now.z, goal.x, kFollow);
  } else if (bright > before && before > 0.0) {  // a scene that lights up
    float growth = max((bright - before) / bright - kMoreLight, 0.0) / (1.0 - kMoreLight);
    shift = kFollow * growth * (goal.x - offset);
    offset += shift;
    white = mix(white, goal.z - offset, kFollow * growth);
  }
  bool has_mean = known && before > 0.0;
  STORE(scale, SCALE_NOW, vec4(push.log_white + offset, 1.0, offset, goal.x));
  STORE(scale, SCALE_MOTION, tracked ? motion : vec4(0.0));
  STORE(scale, SCALE_STATE, vec4(tracked ? state.x + shift : 0.0, has_mean ? mix(before, bright, kMeanRate) : bright,
                                 tracked ? 1.0 : 0.0, white));
}
