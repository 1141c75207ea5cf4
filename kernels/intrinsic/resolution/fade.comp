// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/light_color.glsl"
#include "intrinsic/guide/guide.glsl"

// Fades from one solution's layers to another's over several frames. With kStart saves the difference d of log shading between
// the two, and the frame's m; without it adds to a later frame's log shading
//   share d / (1 + ((m - m_saved) / kStays)^2),
// which vanishes at pixels that changed. One pixel an invocation.
layout(constant_id = 1) const bool kStart = false;
layout(constant_id = 2) const bool kColored = false;
PLANE_IN(0, frame);
PLANE_IN(1, intrinsic);   // R.rgb, S
PLANE_IN(2, shown);       // with kStart: the same of the layers shown so far
PLANE_INOUT(3, between);  // d, m, -, -
PLANE_OUT(4, faded);      // R.rgb, S
PLANE_IN(5, slope);       // with kColored
layout(push_constant) uniform Push {
  uvec2 size;
  float share;
  uint first_row;
} push;

const float kStays = 0.2;  // as TemporalAnchor's hold_texture, log units
const float kMinShading = 1e-20;

void main() {
  if (gl_GlobalInvocationID.x >= push.size.x) return;
  uint at = (push.first_row + gl_GlobalInvocationID.y) * push.size.x + gl_GlobalInvocationID.x;
  vec3 rgb = sanitize(FETCH(frame, int(at)).rgb);
  float m = mean_log(rgb), s = log(max(FETCH(intrinsic, int(at)).w, kMinShading));
  if (kStart) {
    STORE(between, BY_ROWS(at), vec4(log(max(FETCH(shown, int(at)).w, kMinShading)) - s, m, 0.0, 0.0));
  } else {
    vec4 kept = LOAD(between, BY_ROWS(at));
    float off = (m - kept.y) / kStays;
    s += push.share * kept.x / (1.0 + off * off);
    float light = exp(s);
    rgb = kColored ? reflectance_in(rgb, light, FETCH(slope, 0)[SLOPE_K], s - FETCH(slope, 0)[SLOPE_WHITE]) : rgb * exp(-s);
    STORE(faded, BY_ROWS(at), vec4(rgb, light));
  }
}
