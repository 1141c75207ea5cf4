// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "levels.glsl"
#include "poses.glsl"

// Follows strokes into a frame. A workgroup has a stroke: a center c, samples u (places relative to it, with a weight), and their
// template: log intensity T and its gradient at each level, taken when the stroke was drawn. Looks for the place (turn, shift) and
// the change of log intensity g that minimize
//
//   Σ weight ρ(T(u) + g - I(c + shift + turn u)),   ρ'(r) = r / (1 + (r / σ)²)²
//
// by Gauss-Newton steps (inverse compositional: Baker and Matthews 2004) from the coarsest level down; if that fails, again from
// the best of the shifts around. kCheck: with a step on the frame itself decides which strokes need that at all.
layout(constant_id = 1) const bool kCheck = false;
PLANE_IN(0, strokes);
#define TRACK_SLOT 0    // slot, whether it is new, number of samples, its coarsest level
#define TRACK_CENTER 1  // c, rms distance of samples, -
#define TRACK_STRIDE 2
PLANE_IN(1, samples);   // of slots, kSamples each: u, weight, -
PLANE_IN(2, frame);
SCALAR_IN(3, pyramid);
PLANE_INOUT(4, poses);
PLANE_INOUT(5, templates);  // of slots, levels, samples: T, gradient per pixel of the frame, 1 or 0 if it is unknown
WORD_INOUT(6, moved);
layout(push_constant) uniform Push { uvec2 size; } push;

const int kSamples = 1024;
const int kSteps = 5;            // at most, a level
const float kConverged = 0.02;   // step, in pixels of a level
const float kStatic = 0.1;       // pixels: shorter steps are noise
const float kMoved = 0.05;       // pixels: a mask that moves less stays
const float kSharpness = 0.35;   // σ by the template's standard deviation
const float kMinSigma = 0.08;    // log units
const float kMinTexture = 0.03;  // standard deviation of a template that can be followed
const float kFitLost = 0.5;      // share of samples with |r| < σ below which a stroke is lost …
const float kFitFound = 0.65;    // … and from which it is found again
const float kMinSpread = 0.25;   // their variance by the template's: else they are only the even part of it
const float kMinInside = 0.3;    // share of samples inside of the frame
const float kLeaving = 0.6;      // that share below which it has left the frame if it is not found
const float kDamping = 0.02;     // gradient per pixel below which places are not determined
const float kNewTurn = 0.12;     // change of turn or scale after which the template is taken again,
const float kNewFit = 0.15;      // or of the share that fits
const float kChosen = 2.0;       // of a sample that is taken, in place of its last number
// Samples that shifts are tried with, at most. (llvmpipe ends all loops of an invocation after 65535 rounds together.)
const int kSearched = 256;
const int kSearchLevel = 2;      // the coarsest one on which shifts are tried,
const int kReach = 5;            // so many of its pixels away
const float kFar = 0.002;        // added to their variance for a shift of a pixel, squared
const float kFitWell = 0.8;      // share of samples below which shifts are tried
const float kEven = 0.05;        // weight of samples where the template is even

// Sums over the workgroup, of all of some vectors at once: barriers are what compilers of software devices take long for.
const int kSums = 6;
shared vec4 parts[64 * kSums];

void total(inout vec4 sums[kSums], int n) {
  barrier();  // all have read the ones before
  for (int k = 0; k < n; ++k) parts[int(gl_LocalInvocationIndex) * kSums + k] = sums[k];
  barrier();
  for (int k = 0; k < n; ++k) {
    sums[k] = vec4(0.0);
    for (int i = 0; i < int(gl_WorkGroupSize.x); ++i) sums[k] += parts[i * kSums + k];
  }
}

int slot, count, top;
vec2 center;
float radius, sigma, contrast;
vec2 turn, shift;
float gain;

int template_of(int level, int i) { return (slot * kLevels + level) * kSamples + i; }
vec2 warped(vec2 u) { return center + shift + times(turn, u); }
bool inside(vec2 p) { return all(greaterThanEqual(p, vec2(0.0))) && all(lessThanEqual(p, vec2(push.size))); }

// The level that is read, its size and first value.
int level_now;
ivec2 level_size;
int level_start;

void set_level(int level) {
  level_now = level;
  level_size = ivec2(push.size);
  level_start = 0;
  for (int k = 1; k <= level; ++k) {
    level_start += k > 1 ? level_size.x * level_size.y : 0;
    level_size = (level_size + 1) / 2;
  }
}

float texel(ivec2 at) {
  at = clamp(at, ivec2(0), level_size - 1);
  int n = level_start + at.y * level_size.x + at.x;
  return level_now == 0 ? log_light(FETCH(frame, n)) : FETCH1(pyramid, n);
}

// Log intensity at a place of the frame, at the level.
float value_at(vec2 p) {
  p = clamp(p, vec2(-8.0), vec2(push.size) + 8.0) * exp2(-float(level_now)) - 0.5;
  ivec2 at = ivec2(floor(p));
  vec2 part = p - vec2(at);
  return mix(mix(texel(at), texel(at + ivec2(1, 0)), part.x), mix(texel(at + ivec2(0, 1)), texel(at + ivec2(1, 1)), part.x), part.y);
}

// How much a sample tells of where it is: little where the template is even.
float telling(vec4 at, vec4 known) {
  return at.z * clamp(length(known.yz) * exp2(float(level_now)) / contrast, kEven, 1.0);
}

// One step at a level, which moves samples by how many pixels.
float step_at(int level) {
  set_level(level);
  vec4 sums[kSums];
  for (int k = 0; k < kSums; ++k) sums[k] = vec4(0.0);
  for (int i = int(gl_LocalInvocationIndex); i < count; i += int(gl_WorkGroupSize.x)) {
    vec4 at = FETCH(samples, slot * kSamples + i), known = LOAD(templates, template_of(level, i));
    vec2 p = warped(at.xy), u = at.xy / radius, d = known.yz;
    if (known.w == 0.0 || !inside(p)) continue;
    float r = value_at(p) - known.x - gain, fit = 1.0 + r * r / (sigma * sigma), w = at.z / (fit * fit);
    vec4 j = vec4(dot(d, u), d.y * u.x - d.x * u.y, d);
    // The right-hand side is where symmetry leaves room.
    sums[0] += w * j.x * j;
    sums[1] += w * vec4(r * j.x, j.y * j.yzw);
    sums[2] += w * vec4(r * j.yz, j.z * j.zw);
    sums[3] += w * vec4(r * j.w, 0.0, 0.0, j.w * j.w);
    sums[4] += w * j;
    sums[5] += w * vec4(1.0, r, 0.0, 0.0);
  }
  total(sums, kSums);
  // The upper triangle of the normal equations, and Cholesky's factors in its place.
  float a[5][5], b[5];
  float damping = kDamping * exp2(-float(level));
  for (int m = 0; m < 4; ++m) {
    for (int n = m; n < 4; ++n) a[m][n] = sums[m][n];
    a[m][m] += damping * damping * sums[5].x + 1e-9;
    a[m][4] = sums[4][m];
  }
  a[4][4] = sums[5].x + 1e-9;
  b[0] = sums[1].x;
  b[1] = sums[2].x;
  b[2] = sums[2].y;
  b[3] = sums[3].x;
  b[4] = sums[5].y;
  for (int m = 0; m < 5; ++m) {
    for (int k = 0; k < m; ++k) a[m][m] -= a[k][m] * a[k][m];
    a[m][m] = sqrt(max(a[m][m], 1e-12));
    for (int n = m + 1; n < 5; ++n) {
      for (int k = 0; k < m; ++k) a[m][n] -= a[k][m] * a[k][n];
      a[m][n] /= a[m][m];
    }
    for (int k = 0; k < m; ++k) b[m] -= a[k][m] * b[k];
    b[m] /= a[m][m];
  }
  for (int m = 4; m >= 0; --m) {
    for (int n = m + 1; n < 5; ++n) b[m] -= a[m][n] * b[n];
    b[m] /= a[m][m];
  }
  float far = max(length(vec2(b[2], b[3])), length(vec2(b[0], b[1])));
  float most = min(2.0 * exp2(float(level)), 0.3 * radius);
  if (!(far < 1e6)) return 0.0;  // nor for NaN
  float part = min(1.0, most / max(far, 1e-6));
  // The frame lies as the template would after this move: undone first.
  vec2 alpha = vec2(1.0, 0.0) + part * vec2(b[0], b[1]) / radius;
  turn = over(turn, alpha);
  shift -= times(turn, part * vec2(b[2], b[3]));
  gain += b[4];
  return part * far;
}

// The share of samples inside of the frame, the share of these that fit, and the variance of the template over the latter.
vec3 fit_at(int level) {
  set_level(level);
  vec4 sums[kSums];
  sums[0] = sums[1] = vec4(0.0);
  for (int i = int(gl_LocalInvocationIndex); i < count; i += int(gl_WorkGroupSize.x)) {
    vec4 at = FETCH(samples, slot * kSamples + i), known = LOAD(templates, template_of(level, i));
    vec2 p = warped(at.xy);
    float tells = telling(at, known);
    sums[1].x += tells;
    if (known.w == 0.0 || !inside(p)) continue;
    sums[0].x += tells;
    if (!(abs(value_at(p) - known.x - gain) < sigma)) continue;
    sums[1].y += tells;
    sums[0].yzw += at.z * vec3(1.0, known.x, known.x * known.x);
  }
  total(sums, 2);
  vec4 sum = sums[0];
  float mean = sum.z / max(sum.y, 1e-6);
  return vec3(sum.x / max(sums[1].x, 1e-6), sums[1].y / max(sum.x, 1e-6), max(sum.w / max(sum.y, 1e-6) - mean * mean, 0.0));
}

void align(int from) {
  for (int level = from; level >= 0; --level)
    for (int k = 0; k < kSteps; ++k)
      if (!(step_at(level) >= kConverged * exp2(float(level)))) break;
}

// Moves to the best of the shifts around, with no regard to how bright it is there, of pixels of a level and then of finer ones.
void search() {
  int every = (count + kSearched - 1) / kSearched, coarsest = min(top, kSearchLevel);
  for (int level = coarsest; level >= 0; --level) {
    set_level(level);
    int reach = level == coarsest ? kReach : 2;
    vec2 from = shift, best = shift;
    float least = 1e9;
    for (int k = 0; k < (2 * reach + 1) * (2 * reach + 1); ++k) {
      vec2 off = vec2(k % (2 * reach + 1) - reach, k / (2 * reach + 1) - reach);
      shift = from + off * exp2(float(level));
      vec4 sums[kSums];
      sums[0] = vec4(0.0);
      for (int i = every * int(gl_LocalInvocationIndex); i < count; i += every * int(gl_WorkGroupSize.x)) {
        vec4 at = FETCH(samples, slot * kSamples + i), known = LOAD(templates, template_of(level, i));
        vec2 p = warped(at.xy);
        if (known.w == 0.0) continue;
        float apart = inside(p) ? value_at(p) - known.x : 0.0;
        sums[0] += telling(at, known) * vec4(inside(p) ? vec3(1.0, apart, apart * apart) : vec3(0.0), 1.0);
      }
      total(sums, 1);
      vec4 sum = sums[0];
      if (!(sum.x > 0.5 * sum.w)) continue;
      float mean = sum.y / sum.x, off_by = sum.z / sum.x - mean * mean + kFar * dot(off, off);
      if (off_by < least) {
        least = off_by;
        best = shift;
        gain = mean;
      }
    }
    shift = best;
  }
}

// Takes the template of samples, of those that fit or of all. A sample is always of the same invocation.
void take(bool all_of_them) {
  int judged = min(top, 2);
  set_level(judged);
  for (int i = int(gl_LocalInvocationIndex); i < count; i += int(gl_WorkGroupSize.x)) {
    vec2 p = warped(FETCH(samples, slot * kSamples + i).xy);
    vec4 was = LOAD(templates, template_of(judged, i));
    bool chosen = all_of_them || (inside(p) && abs(value_at(p) - was.x - gain) < sigma);
    STORE(templates, template_of(judged, i), vec4(was.xyz, chosen ? kChosen : was.w));
  }
  for (int k = 1; k <= top + 1; ++k) {
    int level = (judged + k) % (top + 1);  // that one last
    set_level(level);
    vec2 right = vec2(exp2(float(level)) / length(turn), 0.0), down = right.yx;
    for (int i = int(gl_LocalInvocationIndex); i < count; i += int(gl_WorkGroupSize.x)) {
      if (LOAD(templates, template_of(judged, i)).w != kChosen) continue;
      vec2 u = FETCH(samples, slot * kSamples + i).xy, p = warped(u);
      vec2 gradient = vec2(value_at(warped(u + right)) - value_at(warped(u - right)),
                           value_at(warped(u + down)) - value_at(warped(u - down)));
      STORE(templates, template_of(level, i), vec4(value_at(p), 0.5 * gradient / right.x, inside(p) ? 1.0 : 0.0));
    }
  }
}

// The template's standard deviation where strokes are judged.
float texture_of() {
  vec4 sums[kSums];
  sums[0] = vec4(0.0);
  for (int i = int(gl_LocalInvocationIndex); i < count; i += int(gl_WorkGroupSize.x)) {
    float weight = FETCH(samples, slot * kSamples + i).z;
    vec4 known = LOAD(templates, template_of(min(top, 2), i));
    sums[0] += weight * known.w * vec4(1.0, known.x, known.x * known.x, 0.0);
  }
  total(sums, 1);
  float all_weights = max(sums[0].x, 1e-6), mean = sums[0].y / all_weights;
  return sqrt(max(sums[0].z / all_weights - mean * mean, 0.0));
}

void main() {
  int from = TRACK_STRIDE * int(gl_WorkGroupID.x);
  vec4 track = FETCH(strokes, from + TRACK_SLOT), around = FETCH(strokes, from + TRACK_CENTER);
  slot = int(track.x);
  count = int(track.z);
  top = int(track.w);
  center = around.xy;
  radius = around.z;
  bool first = gl_LocalInvocationIndex == 0u, fresh = track.y > 0.0;
  uint at = POSE_STRIDE * uint(slot);
  vec4 place = LOAD(poses, at + POSE_PLACE), key = LOAD(poses, at + POSE_KEY), state = LOAD(poses, at + POSE_STATE);
  vec4 known = LOAD(poses, at + POSE_TEMPLATE);
  barrier();  // all have read what the first one will write
  if (fresh) {
    place = key = vec4(1.0, 0.0, 0.0, 0.0);
    state = vec4(STATE_WAITING, 0.0, -1.0, 0.0);
    known = vec4(0.0);
  }
  turn = place.xy;
  shift = place.zw;
  gain = state.w;
  sigma = max(kSharpness * known.x, kMinSigma);
  contrast = max(known.x, kMinTexture);
  bool followed = state.x == float(STATE_FOLLOWED);

  if (kCheck) {
    bool needed = true;
    if (followed && state.z >= 0.0) {
      vec3 fit = fit_at(0);
      float far = step_at(0);
      needed = !(far < kStatic && fit.x > kMinInside && fit.y > state.z - 0.05);
    }
    if (!first) return;
    STORE(moved, MOVED_SLOTS + slot, needed ? 1u : 0u);
    if (needed) STORE(moved, MOVED_ANY, 1u);
    if (!needed) STORE(poses, at + POSE_KEY, vec4(key.xy, 0.0, 0.0));
    return;
  }

  if (LOAD(moved, MOVED_SLOTS + slot) == 0u) return;
  float was = state.x;
  bool waiting = was == float(STATE_WAITING), found = false, retakes = false;
  if (!waiting) {
    if (followed) shift += key.zw;
    int judged = min(top, 2);
    float there = fit_at(judged).x;
    vec3 fit = vec3(0.0);
    vec2 best_turn = turn, best_shift = shift;
    float best_gain = gain;
    for (int attempt = 0; attempt < 2; ++attempt) {
      if (attempt == 1) {
        if (fit.y >= kFitWell) break;
        turn = place.xy;
        shift = place.zw;
        search();
      }
      align(attempt == 0 ? top : min(top, 1));
      vec3 now = fit_at(judged);
      if (attempt == 1 && !(now.y > fit.y)) break;
      fit = now;
      best_turn = turn;
      best_shift = shift;
      best_gain = gain;
    }
    turn = best_turn;
    shift = best_shift;
    gain = best_gain;
    float scale = length(turn);
    found = fit.x >= kMinInside && fit.y >= (followed ? kFitLost : kFitFound) && fit.z >= kMinSpread * known.x * known.x &&
            scale > 0.2 && scale < 5.0;
    if (found) {
      float far = max(length(shift - place.zw), radius * length(turn - place.xy));
      state = vec4(STATE_FOLLOWED, fit.y, 0.0, gain);
      key.zw = followed ? shift - place.zw : vec2(0.0);
      if (!followed || far > kMoved) place = vec4(turn, shift);
      turn = place.xy;
      shift = place.zw;
      known.y = max(known.y, fit.y);
      retakes = fit.x > 0.9 && (length(turn - key.xy) > kNewTurn * length(key.xy) || fit.y < known.y - kNewFit);
      if (retakes) {
        key.xy = turn;
        known.y = fit.y;
      }
      if (first && far > kMoved) STORE(moved, MOVED_STROKES, 1u);
    } else {
      state.x = float(was == float(STATE_OUTSIDE) || (followed && there < kLeaving) ? STATE_OUTSIDE : STATE_LOST);
      key.zw = vec2(0.0);
    }
  }
  if (waiting || retakes) take(waiting);
  if (waiting) {
    known.xy = vec2(texture_of(), 0.0);
    if (known.x >= kMinTexture) state = vec4(STATE_FOLLOWED, 1.0, -1.0, 0.0);
  } else if (found) {
    state.z = fit_at(0).y;
  }
  if (!first) return;
  STORE(poses, at + POSE_PLACE, place);
  STORE(poses, at + POSE_KEY, key);
  STORE(poses, at + POSE_STATE, state);
  STORE(poses, at + POSE_TEMPLATE, known);
  bool drawn = state.x <= float(STATE_FOLLOWED);
  if (drawn != (was <= float(STATE_FOLLOWED))) STORE(moved, MOVED_STROKES, 1u);
}
