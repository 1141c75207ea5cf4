// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"
#include "intrinsic/guide/guide.glsl"
#include "camera/same_surface.glsl"

// Adds to the cells of the prior that their reflectance is known (Eq. 4.8 on cells): with the weight t, V = m' - r' + ln c, r' the
// mean ln reflectance of the points that are known in the cell. t is less where few are, where they are uncertain, and where the
// frame has another depth or color than what is known, as something else is in front of it. One pack of cells an invocation.
PLANE_IN(0, value);
PLANE_IN(1, cells);
PLANE_IN(2, scale);        // .x = ln c (scale.glsl)
PLANE_IN(3, reflectance);  // what is known: ln R; w: confidence, 0...1
SCALAR_IN(4, known_depth);
SCALAR_IN(5, depth);       // of the frame, meters
PLANE_IN(6, valid);        // .x: 0 if nothing of that is
PLANE_OUT(7, known_value);
layout(push_constant) uniform Push {
  uvec2 size;   // cells
  uvec2 frame;  // pixels
  uvec2 known;  // pixels of what is known, which shows the same
  float weight; // for each pixel of the frame
} push;

// Sum of ln R of the known points of a cell, and of their confidence.
vec4 known_of(uvec2 cell) {
  vec4 sum = vec4(0.0);
  for (uint y = 0u; y < 4u; ++y)
    for (uint x = 0u; x < 4u; ++x) {
      uvec2 pixel = min(4u * cell + uvec2(x, y), push.frame - 1u);
      uvec2 from = (2u * pixel + 1u) * push.known / (2u * push.frame);
      int at = int(from.y * push.known.x + from.x);
      vec4 r = FETCH(reflectance, at);
      float confidence = same_surface(FETCH1(depth, at), FETCH1(known_depth, at)) ? r.w : 0.0;
      sum += vec4(confidence > 0.0 ? confidence * r.rgb : vec3(0.0), confidence);
    }
  return sum;
}

// Weight and target of a cell: t, V.
vec2 term_of(uvec2 cell, float log_scale) {
  vec4 guide = FETCH(cells, CELL_STRIDE * int(cell.y * push.size.x + cell.x)), sum = known_of(cell);
  vec3 r = sum.rgb / max(sum.w, 1e-6);
  float mean = (r.r + r.g + r.b) / 3.0;
  // Its chroma where the frame is as bright as here.
  vec2 chroma = guide_of(exp(min(r - mean + guide.x, 9.0)), 0.0).yz, off = (chroma - guide.yz) / kColor;
  float t = push.weight * sum.w / (1.0 + dot(off, off));
  return vec2(sum.w > 0.0 ? t : 0.0, guide.x - mean + log_scale);
}

void main() {
  uint packs = PACK4(push.size.x);
  uvec2 position = grid_position(packs);
  if (position.y >= push.size.y) return;
  vec4 scale_now = FETCH(scale, 0), weight = vec4(0.0), target = weight;
  bool valid_now = FETCH(valid, 0).x > 0.0 && scale_now.y > 0.0;
  for (uint k = 0u; k < 4u; ++k) {
    vec2 term = term_of(uvec2(min(4u * position.x + k, push.size.x - 1u), position.y), scale_now.x);
    weight = vec4(weight.yzw, valid_now ? term.x : 0.0);
    target = vec4(target.yzw, term.y);
  }
  uint at = position.y * packs + position.x;
  weight = MASKED(weight, INSIDE(position.x, push.size.x));
  vec4 v = FETCH(value, int(VALUE_STRIDE * at) + VALUE_WEIGHT), prior = FETCH(value, int(VALUE_STRIDE * at) + VALUE_TARGET);
  vec4 sum = v + weight;
  STORE(known_value, VALUE_STRIDE * at + VALUE_WEIGHT, sum);
  STORE(known_value, VALUE_STRIDE * at + VALUE_TARGET, prior + weight / max(sum, vec4(1e-20)) * (target - prior));
  STORE(known_value, VALUE_STRIDE * at + VALUE_CHROMA, FETCH(value, int(VALUE_STRIDE * at) + VALUE_CHROMA));
}
