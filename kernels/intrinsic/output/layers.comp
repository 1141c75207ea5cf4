// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"
#include "intrinsic/guide/guide.glsl"
#include "image/light_color.glsl"
#include "intrinsic/temporal/temporal.glsl"

// Writes the solution as layers in the output's scale c, S = e^s / c and R = I / S, and the history for the next frame. With
// kColored, R is divided by the color of light, too. With kAnchored, reflectance moves only part of the way from the frame before, so that sensor noise is averaged over frames and stays
// in shading: by the share of the cells, interpolated between them, and less if a pixel changed otherwise than its cell. One cell,
// 4 x 4 pixels, an invocation.
layout(constant_id = 1) const bool kAnchored = false;
layout(constant_id = 2) const bool kColored = false;
PLANE_IN(0, frame);
PLANE_IN(1, cells);
PLANE_IN(2, guide_coarse);
PLANE_IN(3, scale);  // .x = ln c (scale.glsl)
PLANE_IN(4, start);  // of cells (cell_terms.comp)
PLANE_IN(5, before);    // m and the brightness of reflectance, the last frame's
PLANE_IN(6, now);       // m (assemble.comp)
PLANE_IN(7, shading);
PLANE_OUT(8, memory);   // the same buffer as `now`: the brightness of reflectance
PLANE_OUT(9, new_shading);  // the same buffer as `shading`
PLANE_INOUT(10, cell_history);
PLANE_OUT(11, intrinsic);
PLANE_IN(12, slope);
layout(push_constant) uniform Push {
  uvec2 size;
  float texture;  // 1 / (difference between the changes of a pixel and its cell that halves the kept share)
} push;

uint packs = PACK4(push.size.x);

float hold_of(int x, int y) { return FETCH(start, START_STRIDE * (y * int(PACK4(packs)) + x / 4) + START_HOLD)[x & 3]; }
// The kept share of a row of cells: this one and those at its sides.
vec3 holds_of(ivec2 cell, int y) {
  return vec3(hold_of(max(cell.x - 1, 0), y), hold_of(cell.x, y), hold_of(min(cell.x + 1, int(packs) - 1), y));
}

void main() {
  uvec2 cell = grid_position(packs);
  uint first = 4u * cell.y;
  if (first >= push.size.y) return;
  uvec2 count = min(push.size - 4u * cell, uvec2(4u));
  float log_scale = FETCH(scale, 0).x;
  vec4 of_light = kColored ? FETCH(slope, 0) : vec4(0.0);
  uint at = cell.y * packs + cell.x;
  vec4 guide = FETCH(cells, int(CELL_STRIDE * at));
  float change = 0.0;
  vec3 above = vec3(0.0), here = above, below = above;
  if (kAnchored) {
    int y = int(cell.y), last = int(push.size.y + 3u) / 4 - 1;
    change = guide.x - LOAD(cell_history, at).w;
    above = holds_of(ivec2(cell), max(y - 1, 0));
    here = holds_of(ivec2(cell), y);
    below = holds_of(ivec2(cell), min(y + 1, last));
  }
  for (uint y = 0u; y < count.y; ++y) {
    uint pack = (first + y) * packs + cell.x;
    int mean = int(MEMORY_STRIDE * pack) + MEMORY_MEAN, brightness = int(MEMORY_STRIDE * pack) + MEMORY_BRIGHTNESS;
    vec4 s = FETCH(shading, int(pack)), bright = vec4(0.0);
    for (uint x = 0u; x < 4u; ++x) {
      vec3 rgb = sanitize(FETCH(frame, int((first + y) * push.size.x + min(4u * cell.x + x, push.size.x - 1u))).rgb);
      bright = vec4(bright.yzw, rgb.r + rgb.g + rgb.b);
    }
    bright = log(bright / 3.0 + kIntensityFloor);
    if (kAnchored) {
      float down = 0.25 * float(y) - 0.375;  // from the cell's center, in cells
      vec3 row = down < 0.0 ? mix(here, above, -down) : mix(here, below, down);
      vec4 hold = vec4(mix(row.yy, row.xx, vec2(0.375, 0.125)), mix(row.yy, row.zz, vec2(0.125, 0.375)));
      vec4 off = push.texture * (FETCH(now, mean) - FETCH(before, mean) - change);
      hold /= 1.0 + off * off;
      s += MASKED(hold * (bright - FETCH(before, brightness) - s), INSIDE(cell.x, push.size.x));
      STORE(new_shading, pack, s);
    }
    STORE(memory, uint(brightness), bright - s);
    for (uint x = 0u; x < count.x; ++x) {
      uint pixel = (first + y) * push.size.x + 4u * cell.x + x;
      vec3 rgb = sanitize(FETCH(frame, int(pixel)).rgb);
      float light = exp(s.x - log_scale);
      vec3 reflectance = kColored ? reflectance_in(rgb, light, of_light[SLOPE_K], s.x - log_scale - of_light[SLOPE_WHITE]) : rgb * (1.0 / light);
      STORE(intrinsic, pixel, vec4(reflectance, light));
      s = s.yzwx;
    }
  }
  STORE(cell_history, at, cell_state(guide, FETCH(guide_coarse, int((cell.y / 4u) * PACK4(packs) + cell.x / 4u))));
}
