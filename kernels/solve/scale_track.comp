// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/random.glsl"
#include "solve/darkest.glsl"
#include "solve/scale.glsl"

// Tracks points from the last frame's cells to this one's (Lucas and Kanade 1981, one level, windows of 5 x 5 cells; their mean
// is removed, so that light and its color may change), and compares their reflectance with that of two seconds before. A lost
// point starts again where points are sparse. One point an invocation.
PLANE_IN(0, before);
PLANE_IN(1, now);
PLANE_IN(2, scale);
PLANE_IN(3, points);
PLANE_OUT(4, moved_points);
PLANE_INOUT(5, history);
PLANE_OUT(6, samples);
PLANE_IN(7, light);  // .xy: k and m of white by which the color of `now` was corrected
layout(push_constant) uniform Push {
  uvec2 size;     // of the cells
  uvec2 grid;     // of the points
  float spacing;  // cells from point to point
  uint frame;     // number of the last frame
} push;

const int kReach = 2;             // cells from a window's center to its border
const int kIterations = 3;
const float kCommonMotion = 0.1;  // weight of the common motion, squared log units; points without texture follow it
const float kMismatch = 0.1;      // rms log units by which a window may change
const float kSteep = 0.05;        // max share of the gradients' mean square that may remain
const float kRenew = 0.003;       // share of the frame's own offset that a new point takes
const float kBlack = -5.3;        // ln of .5 %: darker points do not count
const float kGraySlope = 0.05;    // of light, that hardly tells whether its color changed
const float kDim = 0.1;           // of full scale: darker points hardly have a color to tell by
const uint kCandidates = 8u;      // places for a new point

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

// Of random places the one farthest from all points that go on.
vec2 sparse_place(uint i, uint count) {
  vec2 candidates[kCandidates];
  float nearest[kCandidates];
  for (uint k = 0u; k < kCandidates; ++k) {
    candidates[k] = vec2(pcg3d(uvec3(i, push.frame, k)).xy >> 8u) / 16777216.0 * vec2(last);
    nearest[k] = 1e9;
  }
  for (uint j = 0u; j < count; ++j) {
    vec4 other = FETCH(points, int(j));
    if (other.z < 0.0) continue;
    for (uint k = 0u; k < kCandidates; ++k) {
      vec2 apart = other.xy - candidates[k];
      nearest[k] = min(nearest[k], dot(apart, apart));
    }
  }
  uint best = 0u;
  for (uint k = 1u; k < kCandidates; ++k)
    if (nearest[k] > nearest[best]) best = k;
  return candidates[best];
}

void main() {
  uint i = line_index(), count = push.grid.x * push.grid.y;
  if (i >= count) return;
  vec4 scale_now = FETCH(scale, SCALE_NOW), state = FETCH(scale, SCALE_STATE), was_lit = FETCH(scale, SCALE_LIGHT);
  vec4 place = FETCH(points, int(i));
  float offset = scale_now.z;
  bool has_history = state.z > 0.0;
  if (!has_history || !(place.z >= 0.0)) {
    place.xy = has_history ? sparse_place(i, count)
                       : min((vec2(i % push.grid.x, i / push.grid.x) + 0.5) * push.spacing - 0.5, vec2(last));
    place.z = 0.0;
    offset = mix(scale_now.z, scale_now.w, kRenew);
  }
  vec4 past = before_between(place.xy);
  STORE(history, HISTORY_SPAN * i + push.frame % HISTORY_SPAN,
        vec4(past.w + offset - state.x, past.x, seen_color(past, was_lit.yz), was_lit.x));

  // The window as it was, with a border for gradients.
  const int across = 2 * kReach + 3;
  vec3 window[across * across];
  for (int k = 0; k < across * across; ++k)
    window[k] = before_between(place.xy + vec2(k % across - kReach - 1, k / across - kReach - 1)).xyz;
  const float cells = float((2 * kReach + 1) * (2 * kReach + 1));
  vec3 squares;  // sums of gx^2, gy^2, gx gy
  vec2 expected = common_motion(FETCH(scale, SCALE_MOTION), place.xy - 0.5 * vec2(last)), moved = expected;
  float mismatch;
  for (int pass = 0; pass <= kIterations; ++pass) {
    vec2 sum = vec2(0.0);
    vec3 slope_x = vec3(0.0), slope_y = vec3(0.0), change = vec3(0.0);
    float differ = 0.0;
    squares = vec3(0.0);
    for (int k = 0; k < (2 * kReach + 1) * (2 * kReach + 1); ++k) {
      ivec2 p = ivec2(k % (2 * kReach + 1), k / (2 * kReach + 1));
      int at = (p.y + 1) * across + p.x + 1;
      vec3 gx = 0.5 * (window[at + 1] - window[at - 1]), gy = 0.5 * (window[at + across] - window[at - across]);
      vec3 step = window[at] - now_between(place.xy + vec2(p - kReach) + moved).xyz;
      squares += vec3(dot(gx, gx), dot(gy, gy), dot(gx, gy));
      slope_x += gx;
      slope_y += gy;
      sum += vec2(dot(step, gx), dot(step, gy));
      change += step;
      differ += dot(step, step);
    }
    mismatch = (differ - dot(change, change) / cells) / cells;
    if (pass == kIterations) break;
    vec2 gradient = sum - vec2(dot(slope_x, change), dot(slope_y, change)) / cells + kCommonMotion * (expected - moved);
    vec2 diagonal = squares.xy + kCommonMotion;
    vec2 step = vec2(diagonal.y * gradient.x - squares.z * gradient.y, diagonal.x * gradient.y - squares.z * gradient.x) /
                (diagonal.x * diagonal.y - squares.z * squares.z);
    moved += clamp(step, vec2(-1.0), vec2(1.0));
  }
  place.xy += moved;
  vec4 cell = now_between(place.xy);
  bool found = all(greaterThanEqual(place.xy, vec2(1.0))) && all(lessThanEqual(place.xy, vec2(last - 1))) &&
               mismatch <= kMismatch * kMismatch + kSteep * (squares.x + squares.y) / cells;
  float half_sum = 0.5 * (squares.x + squares.y), half_difference = 0.5 * (squares.x - squares.y);
  float texture = half_sum - sqrt(half_difference * half_difference + squares.z * squares.z);
  if (!(texture > 0.0)) texture = 0.0;  // or NaN
  place.z = found ? min(place.z + 1.0, 1e6) : -1.0;
  uint age = uint(clamp(place.z, 1.0, float(HISTORY_SPAN))), newest = max(age, HISTORY_OLDEST) - HISTORY_OLDEST + 1u;
  vec4 reference = vec4(0.0);
  for (uint k = newest; k <= age; ++k)  // the last frame is 1 old
    reference += LOAD(history, HISTORY_SPAN * i + (push.frame + HISTORY_SPAN + 1u - k) % HISTORY_SPAN);
  reference = reference / float(age - newest + 1u) + vec4(state.x, 0.0, 0.0, 0.0);
  // Along the line of light's color brightness changes with color; the exposure changes without.
  vec2 line = FETCH(light, 0).xy;
  float brighter = cell.x - reference.y, redder = seen_color(cell, line) - reference.z;
  float light_now = exp(cell.x), trust = light_now / (light_now + kDim);
  float along = redder * line.x / (line.x * line.x + kGraySlope * kGraySlope);
  float exposure = reference.w + clamp(brighter - along, min(brighter, 0.0), max(brighter, 0.0));
  float weight = found && cell.x > kBlack ? float(age) / float(HISTORY_SPAN) : 0.0;
  STORE(moved_points, i, place);
  STORE(samples, SAMPLE_STRIDE * i + SAMPLE_OFFSET,
        vec4(reference.x - cell.w, weight, texture, cell.x > kDarkest ? 1.0 : 0.0));
  STORE(samples, SAMPLE_STRIDE * i + SAMPLE_MOTION, vec4(moved, weight > 0.0 ? trust * trust : 0.0, exposure));
}
