// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "matte.glsl"

// The matte of every pixel, and what is behind it where it is partly covered; combined with the mask that came in.
layout(constant_id = 1) const bool OF_PIXELS = false;  // alpha is x of `selection`, else of cells
layout(constant_id = 2) const bool SOFT = true;        // alpha at the border follows the frame
layout(constant_id = 3) const int COMBINE = 0;
layout(constant_id = 4) const bool INVERT = false;
const int kReplace = 0, kAdd = 1, kSubtract = 2, kIntersect = 3;
PLANE_IN(0, frame);
PLANE_IN(1, reflectance);
SCALAR_IN(2, alpha);
WORD_IN(3, classes);
PLANE_IN(4, object);
PLANE_IN(5, behind);
PLANE_IN(6, selection);
PLANE_IN(7, mask);
PLANE_OUT(8, combined);  // x: matte; rgb in yzw: reflectance behind it minus that of the pixel
layout(push_constant) uniform Push {
  uvec2 size;
  uvec2 cells;
  float per_cell;  // 1 / side
  uint first_row;
} push;

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y);
  if (at.x >= push.size.x || at.y >= push.size.y) return;
  int n = int(at.y * push.size.x + at.x);
  vec2 place = clamp((vec2(at) + 0.5) * push.per_cell - 0.5, vec2(0.0), vec2(push.cells - 1u));
  ivec2 first = ivec2(place), last = min(first + 1, ivec2(push.cells) - 1);
  vec2 part = place - vec2(first);
  int width = int(push.cells.x);
  ivec4 cells = ivec4(first.y * width + first.x, first.y * width + last.x, last.y * width + first.x, last.y * width + last.x);
  vec4 shares = vec4((1.0 - part.x) * (1.0 - part.y), part.x * (1.0 - part.y), (1.0 - part.x) * part.y, part.x * part.y);

  float border = 0.0, cover = 0.0;
  vec4 own = vec4(0.0), other = vec4(0.0);
  for (int k = 0; k < 4; ++k) {
    uint kind = FETCH1(classes, cells[k]);
    if (!OF_PIXELS) cover += shares[k] * ((kind & kBorder) != 0u ? FETCH1(alpha, cells[k]) : kind == kCore ? 1.0 : 0.0);
    if ((kind & kBorder) == 0u || !SOFT) continue;
    border += shares[k];
    vec4 seen = FETCH(object, cells[k]);
    own += shares[k] * seen.w * vec4(seen.rgb, 1.0);
    seen = FETCH(behind, cells[k]);
    other += shares[k] * seen.w * vec4(seen.rgb, 1.0);
  }
  if (OF_PIXELS) cover = min(finite(FETCH(selection, n)).x, 1.0);
  float matte = SOFT || OF_PIXELS ? cover : cover > 0.5 ? 1.0 : 0.0;
  vec3 delta = vec3(0.0);
  if (SOFT && border > 0.0 && own.w > 0.0 && other.w > 0.0) {
    vec3 front = own.rgb / own.w, back = other.rgb / other.w, across = front - back, mean = 0.5 * (front + back);
    vec3 seen = finite(FETCH(frame, n)).rgb;
    float length2 = dot(across, across), along = dot(seen - back, across) / max(length2, 1e-12);
    float contrast = length2 / (length2 + kApart * kApart * dot(mean, mean) + 1e-12);
    along = clamp((along - kMargin) / (1.0 - 2.0 * kMargin), 0.0, 1.0);
    matte = mix(cover, mix(cover, along, contrast), min(2.0 * border, 1.0));
    if (matte > 0.0 && matte < 1.0) {
      vec3 paint = finite(FETCH(reflectance, n)).rgb;
      vec3 hidden = INVERT ? front : back;
      delta = contrast * (min(paint * hidden / max(seen, vec3(1e-4)), vec3(4.0)) - paint);
    }
  }
  if (INVERT) matte = 1.0 - matte;
  if (COMBINE != kReplace) {
    vec4 before = FETCH(mask, n);
    before.x = min(finite(before).x, 1.0);
    vec3 known = mix(vec3(0.0), before.yzw, lessThan(abs(before.yzw), vec3(kLargest)));  // not NaN
    if (COMBINE == kAdd) {
      delta = matte > before.x ? delta : known;
      matte = max(matte, before.x);
    } else {
      if (COMBINE == kSubtract) matte = 1.0 - matte;
      delta = matte < before.x ? delta : known;
      if (COMBINE == kSubtract && matte < before.x) delta = vec3(0.0);  // what is in front is not what is behind
      matte = min(matte, before.x);
    }
  }
  STORE(combined, BY_ROWS(n), vec4(matte, delta));
}
