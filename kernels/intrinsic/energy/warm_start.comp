// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"
#include "intrinsic/guide/guide.glsl"
#include "intrinsic/temporal/temporal.glsl"

// Turns a frame's layers, found at another resolution, into the history of the frame before: the same frame is then solved again
// from it. One pack of cells an invocation.
PLANE_IN(0, frame);
PLANE_IN(1, intrinsic);  // R.rgb, S
PLANE_IN(2, cells);
PLANE_IN(3, guide_coarse);
PLANE_IN(4, scale);  // .x = ln c (scale.glsl)
PLANE_IN(5, level0);
PLANE_OUT(6, memory);
PLANE_OUT(7, shading);
PLANE_OUT(8, kept);
PLANE_OUT(9, means);       // of the cells ...
PLANE_OUT(10, correction);  // ... with nothing yet to be added
PLANE_OUT(11, source_term);      // 0: the old source term belongs to another system
layout(push_constant) uniform Push { uvec2 size; } push;

const float kMinShading = 1e-20;

void main() {
  uvec2 cell_size = ((push.size + 1u) / 2u + 1u) / 2u;
  uint packs = PACK4(push.size.x), cell_packs = PACK4(cell_size.x);
  uvec2 position = grid_position(cell_packs);
  if (position.y >= cell_size.y) return;
  float log_scale = FETCH(scale, 0).x;
  vec4 mean = vec4(0.0);
  for (uint k = 0u; k < 4u; ++k) {
    uvec2 cell = uvec2(4u * position.x + k, position.y);
    mean = mean.yzwx;
    if (cell.x >= cell_size.x) continue;
    uvec2 first = 4u * cell, count = min(push.size - first, uvec2(4u));
    vec4 columns = cell_weights(count.x), rows = cell_weights(count.y);
    for (uint y = first.y; y < first.y + count.y; ++y) {
      vec4 m = vec4(0.0), s = m, bright = m;
      for (uint x = 0u; x < 4u; ++x) {
        int pixel = int(y * push.size.x + first.x + min(x, count.x - 1u));
        vec3 rgb = sanitize(FETCH(frame, pixel).rgb);
        m = vec4(m.yzw, FETCH(level0, pixel).x);
        s = vec4(s.yzw, log(max(FETCH(intrinsic, pixel).w, kMinShading)) + log_scale);
        bright = vec4(bright.yzw, log((rgb.r + rgb.g + rgb.b) / 3.0 + kIntensityFloor));
      }
      uint pack = y * packs + cell.x;
      STORE(memory, MEMORY_STRIDE * pack + MEMORY_MEAN, m);
      STORE(memory, MEMORY_STRIDE * pack + MEMORY_BRIGHTNESS, bright - s);
      STORE(shading, pack, MASKED(s, INSIDE(cell.x, push.size.x)));
      mean.w += rows.x * dot(columns, s);
      rows = rows.yzwx;
    }
    uint at = cell.y * cell_size.x + cell.x;
    STORE(kept, at, cell_state(FETCH(cells, int(CELL_STRIDE * at)), FETCH(guide_coarse, int((cell.y / 4u) * cell_packs + cell.x / 4u))));
  }
  uint to = position.y * cell_packs + position.x;
  STORE(means, to, mean);
  STORE(correction, to, vec4(0.0));
  STORE(source_term, SOURCE_STRIDE * to + SOURCE_VALUE, vec4(0.0));
}
