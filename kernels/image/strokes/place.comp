// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "poses.glsl"
#include "strokes.glsl"

// Places strokes where they have moved to. One stroke an invocation.
PLANE_IN(0, drawn);  // of strokes, as they were drawn
#define DRAWN_KIND 0    // kind, whether it is filled, slot, whether it is in the scene
#define DRAWN_COLOR 1
#define DRAWN_PATCH 2   // place of its first texel on the picture, texels along x and y
#define DRAWN_CENTER 3  // of POSE_PLACE, pixels of the frame; first texel of the patch / 16, -
#define DRAWN_STRIDE 4
PLANE_IN(1, poses);
PLANE_OUT(2, strokes);
layout(constant_id = 1) const bool kFollowed = false;
layout(push_constant) uniform Push {
  uvec2 size;  // of the picture
  vec2 scale;  // its pixels along one of the frame
  uint count;
  float step;  // pixels along a texel
} push;

const float kMargin = 1.0;  // texels around a patch from which it fades to 0

void main() {
  uint i = line_index();
  if (i >= push.count) return;
  int from = DRAWN_STRIDE * int(i);
  vec4 kind = FETCH(drawn, from + DRAWN_KIND), patch_at = FETCH(drawn, from + DRAWN_PATCH), center = FETCH(drawn, from + DRAWN_CENTER);
  vec2 turn = vec2(1.0, 0.0), shift = vec2(0.0), c = center.xy * push.scale;
  bool visible = patch_at.z > 0.0;
  if (kFollowed) {
    int at = POSE_STRIDE * int(kind.z);
    vec4 place = FETCH(poses, at + POSE_PLACE);
    turn = place.xy;
    shift = place.zw * push.scale;
    visible = visible && FETCH(poses, at + POSE_STATE).x <= float(STATE_FOLLOWED);
  }
  // Its corners' places.
  vec2 low = vec2(1e9), high = vec2(-1e9);
  for (uint k = 0u; k < 4u; ++k) {
    vec2 corner = patch_at.xy - kMargin + (patch_at.zw + 2.0 * kMargin) * vec2(k & 1u, k >> 1u);
    vec2 p = c + shift + times(turn, corner * push.step - c);
    low = min(low, p);
    high = max(high, p);
  }
  vec2 cells = vec2((push.size + 3u) / 4u);
  vec4 box = clamp(vec4(floor(low / 4.0), ceil(high / 4.0)), vec4(0.0), cells.xyxy);
  visible = visible && box.x < box.z && box.y < box.w;
  vec2 inverse_turn = over(vec2(1.0, 0.0), turn);
  bool filled = kind.y > 0.0, in_scene = kind.w > 0.0;
  uint to = STROKE_STRIDE * i;
  STORE(strokes, to + STROKE_BOUNDS, in_scene || (visible && filled) ? vec4(0.0, 0.0, cells) : visible ? box : vec4(0.0));
  STORE(strokes, to + STROKE_KIND, vec4(kind.xy, visible || in_scene ? 1.0 : 0.0, 0.0));
  STORE(strokes, to + STROKE_COLOR, FETCH(drawn, from + DRAWN_COLOR));
  STORE(strokes, to + STROKE_BOX, visible ? box : vec4(0.0));
  STORE(strokes, to + STROKE_MAP,
        vec4(inverse_turn / push.step, (c - times(inverse_turn, c + shift)) / push.step - patch_at.xy));
  STORE(strokes, to + STROKE_PATCH, vec4(patch_at.zw, center.z, 0.0));
}
