// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "solve/scale.glsl"

// Tracks points from the last frame's cells to this one's (Lucas and Kanade 1981, one level, windows of 5 x 5 cells; the mean of
// log intensity is removed, so that light may change). A lost point starts again at its place on the grid. One point an
// invocation.
PLANE_IN(0, before);
PLANE_IN(1, now);
PLANE_IN(2, scale);
PLANE_INOUT(3, points);
PLANE_OUT(4, samples);
layout(push_constant) uniform Push {
  uvec2 size;     // of the cells
  uvec2 grid;     // of the points
  float spacing;  // cells from point to point
} push;

const int kReach = 2;             // cells from a window's center to its border
const int kIterations = 3;
const float kCommonMotion = 0.1;  // weight of the common motion, squared log units; points without texture follow it
const float kMismatch = 0.1;      // rms log units by which a window may change
const float kSteep = 0.05;        // max share of the gradients' mean square that may remain
const float kColorChange = 0.3;   // log units by which a point's chroma may change
const float kTexture = 0.1;       // min eigenvalue of the gradients' squares that halves a point's weight
const float kTrusted = 10.0;      // frames until a point has its whole weight
const float kRenew = 0.003;       // share of the frame's own offset that a new point takes
const float kDarkest = -3.9;      // ln of 2 % of full scale

ivec2 last = ivec2(push.size) - 1;
vec4 before_at(ivec2 p) {
  p = clamp(p, ivec2(0), last);
  return FETCH(before, p.y * int(push.size.x) + p.x);
}
vec4 now_at(ivec2 p) {
  p = clamp(p, ivec2(0), last);
  return FETCH(now, p.y * int(push.size.x) + p.x);
}
vec4 now_between(vec2 p) {
  ivec2 low = ivec2(floor(p));
  vec2 part = p - vec2(low);
  return mix(mix(now_at(low), now_at(low + ivec2(1, 0)), part.x),
             mix(now_at(low + ivec2(0, 1)), now_at(low + ivec2(1, 1)), part.x), part.y);
}
vec4 before_between(vec2 p) {
  ivec2 low = ivec2(floor(p));
  vec2 part = p - vec2(low);
  return mix(mix(before_at(low), before_at(low + ivec2(1, 0)), part.x),
             mix(before_at(low + ivec2(0, 1)), before_at(low + ivec2(1, 1)), part.x), part.y);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.grid.x * push.grid.y) return;
  vec4 scale_now = FETCH(scale, SCALE_NOW), motion = FETCH(scale, SCALE_MOTION);
  vec4 place = LOAD(points, POINT_STRIDE * i + POINT_PLACE), color = LOAD(points, POINT_STRIDE * i + POINT_COLOR);
  place.z += FETCH(scale, SCALE_SHIFT).x;
  if (!(motion.w > 0.0) || !(place.w >= 0.0)) {
    vec2 home = min((vec2(i % push.grid.x, i / push.grid.x) + 0.5) * push.spacing - 0.5, vec2(last));
    vec4 cell = before_between(home);
    place = vec4(home, cell.w + mix(scale_now.z, scale_now.w, kRenew), 0.0);
    color = vec4(cell.yz, 0.0, 0.0);
  }

  // The window as it was, with a border for gradients.
  const int across = 2 * kReach + 3;
  vec3 window[across * across];
  for (int k = 0; k < across * across; ++k)
    window[k] = before_between(place.xy + vec2(k % across - kReach - 1, k / across - kReach - 1)).xyz;
  const float count = float((2 * kReach + 1) * (2 * kReach + 1));
  vec3 squares;  // sums of gx^2, gy^2, gx gy
  vec2 moved = motion.xy;
  float mismatch;
  for (int pass = 0; pass <= kIterations; ++pass) {
    vec2 sum = vec2(0.0), slope = vec2(0.0);  // slope: of m
    float brighter = 0.0, differ = 0.0;
    squares = vec3(0.0);
    for (int k = 0; k < (2 * kReach + 1) * (2 * kReach + 1); ++k) {
      ivec2 p = ivec2(k % (2 * kReach + 1), k / (2 * kReach + 1));
      int at = (p.y + 1) * across + p.x + 1;
      vec3 gx = 0.5 * (window[at + 1] - window[at - 1]), gy = 0.5 * (window[at + across] - window[at - across]);
      vec3 step = window[at] - now_between(place.xy + vec2(p - kReach) + moved).xyz;
      squares += vec3(dot(gx, gx), dot(gy, gy), dot(gx, gy));
      slope += vec2(gx.x, gy.x);
      sum += vec2(dot(step, gx), dot(step, gy));
      brighter += step.x;
      differ += dot(step, step);
    }
    mismatch = (differ - brighter * brighter / count) / count;
    if (pass == kIterations) break;
    vec2 pull = sum - slope * brighter / count + kCommonMotion * (motion.xy - moved);
    vec2 diagonal = squares.xy + kCommonMotion;
    vec2 step = vec2(diagonal.y * pull.x - squares.z * pull.y, diagonal.x * pull.y - squares.z * pull.x) /
                (diagonal.x * diagonal.y - squares.z * squares.z);
    moved += clamp(step, vec2(-1.0), vec2(1.0));
  }
  place.xy += moved;
  vec4 cell = now_between(place.xy);
  vec2 change = abs(cell.yz - color.xy);
  bool found = all(greaterThanEqual(place.xy, vec2(1.0))) && all(lessThanEqual(place.xy, vec2(last - 1))) &&
               mismatch <= kMismatch * kMismatch + kSteep * (squares.x + squares.y) / count &&
               max(change.x, change.y) <= kColorChange;
  bool bright = cell.x > kDarkest;
  float half_sum = 0.5 * (squares.x + squares.y), half_difference = 0.5 * (squares.x - squares.y);
  float texture = max(half_sum - sqrt(half_difference * half_difference + squares.z * squares.z), 0.0);
  place.w = found ? min(place.w + 1.0, 1e6) : -1.0;
  float weight = found && bright ? min(place.w / kTrusted, 1.0) * texture / (texture + kTexture) : 0.0;
  STORE(points, POINT_STRIDE * i + POINT_PLACE, place);
  STORE(points, POINT_STRIDE * i + POINT_COLOR, color);
  STORE(samples, SAMPLE_STRIDE * i + SAMPLE_OFFSET,
        vec4(place.z - cell.w, weight, found ? texture : 0.0, bright ? 1.0 : 0.0));
  STORE(samples, SAMPLE_STRIDE * i + SAMPLE_MOTION, vec4(moved, found && bright ? 1.0 : 0.0, 0.0));
}
