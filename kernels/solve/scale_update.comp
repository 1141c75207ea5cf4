// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "solve/scale.glsl"

// The scale of a frame: a robust mean of the offsets that keep the points' reflectance; at a start or a cut the scale of the frame
// alone. One workgroup.
PLANE_IN(0, samples);
PLANE_IN(1, wanted);    // .x: offset that the frame alone would get, .y: 0 if all of it is dark
PLANE_IN(2, decision);  // .y = 0 at a cut
PLANE_INOUT(3, scale);
layout(push_constant) uniform Push {
  uint points;      // 0: none were followed
  float log_white;  // ln of the white level
  uint history;     // 0: no frame before; 1: one, on which `decision` decides; 2: one without a decision
  uint frozen;      // 1: the scale stays
} push;

const int kRounds = 6;
const float kWidth = 0.1;         // log units from the mean that halve a point's weight
const float kFewest = 0.05;       // share of the points that must be found again
const float kFollow = 0.1;        // share of the frame's own offset if fewer are
const float kMoreLight = 0.25;    // growth of the bright share from which the frame's own offset counts
const float kRemember = 1.0 / 64.0;  // share of the newest frame in the mean bright share

void main() {
  uint lane = gl_LocalInvocationID.x, lanes = gl_WorkGroupSize.x;
  vec4 now = LOAD(scale, SCALE_NOW), motion = LOAD(scale, SCALE_MOTION);
  vec2 asked = FETCH(wanted, 0).xy;
  bool carries = push.history == 2u || (push.history == 1u && FETCH(decision, 0).y > 0.0);
  bool known = carries && now.y > 0.0;

  float offset = now.z;
  vec2 together = motion.xy;
  for (int round = 0; round < kRounds; ++round) {
    vec4 sum = vec4(0.0), moved = vec4(0.0);
    for (uint i = lane; i < push.points; i += lanes) {
      vec4 sample_offset = FETCH(samples, int(SAMPLE_STRIDE * i) + SAMPLE_OFFSET);
      vec4 sample_motion = FETCH(samples, int(SAMPLE_STRIDE * i) + SAMPLE_MOTION);
      float away = (sample_offset.x - offset) / kWidth;
      float weight = sample_offset.y / (1.0 + away * away);
      vec2 apart = sample_motion.xy - together;
      float steady = sample_offset.z / (1.0 + dot(apart, apart));
      if (sample_motion.z > 0.0) {
        sum += vec4(weight * sample_offset.x, weight, 1.0, 0.0);
        moved += vec4(steady * sample_motion.xy, steady, 0.0);
      }
      sum.w += sample_offset.w;
    }
    sum = workgroup_sum(sum);
    moved = workgroup_sum(moved);
    if (sum.y > 1e-6) offset = sum.x / sum.y;
    if (moved.z > 1e-6) together = moved.xy / moved.z;
    motion.zw = vec2(sum.w, sum.z) / max(float(push.points), 1.0);  // shares of bright points, and of those found again
  }
  if (lane > 0u) return;
  float bright = motion.z, found = motion.w, before = LOAD(scale, SCALE_MOTION).z;

  // A dark frame changes nothing; if no scale is known, the solver's own stays.
  if (asked.y == 0.0) {
    STORE(scale, SCALE_NOW, known ? vec4(push.log_white + now.z, now.yz, now.z) : vec4(0.0));
    STORE(scale, SCALE_MOTION, vec4(0.0, 0.0, before, 0.0));
    STORE(scale, SCALE_SHIFT, vec4(0.0));
    return;
  }
  bool follows = known && found > kFewest;
  float shift = 0.0;
  if (!known) {
    offset = asked.x;
  } else if (push.frozen == 1u || push.points == 0u) {
    offset = now.z;
  } else if (!follows) {
    offset = mix(now.z, asked.x, kFollow);
  } else if (bright > before && before > 0.0) {  // a scene that lights up
    float growth = max((bright - before) / bright - kMoreLight, 0.0) / (1.0 - kMoreLight);
    shift = kFollow * growth * (asked.x - offset);
    offset += shift;
  }
  bool remembers = known && before > 0.0;
  STORE(scale, SCALE_NOW, vec4(push.log_white + offset, 1.0, offset, asked.x));
  STORE(scale, SCALE_MOTION, vec4(follows ? together : vec2(0.0), remembers ? mix(before, bright, kRemember) : bright,
                                  follows ? 1.0 : 0.0));
  STORE(scale, SCALE_SHIFT, vec4(shift, 0.0, 0.0, 0.0));
}
