#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "../image/workgroup_sum.glsl"
#include "global.glsl"

// Base colors: modes of the histogram of chroma without tint, mixed with that of the frames before; their slots; and which bin
// belongs to whom. Also what the whole scene says of its tint. One workgroup.
WORD_IN(0, histogram);
PLANE_IN(1, lit);
SCALAR_INOUT(2, carried);     // kBins: the mixed histogram, sum 1
SCALAR_INOUT(3, heights);     // 2 kBins: scratch
WORD_INOUT(4, words);         // 4 kBins: scratch: who climbs where; mass and moments of basins
WORD_OUT(5, table);           // kBins: slot of a bin
PLANE_INOUT(6, base);         // kSlots: center, 1 if used, mass; and how many are used
PLANE_INOUT(7, scene);
layout(push_constant) uniform Push {
  uint count;  // points of the grid
  float least_share;
  float same;
  float gate;
} push;

const float kSigma = 1.2;
const int kReach = 4;
const float kMass = 1073741824.0;   // 2^30
const float kMoment = 33554432.0;   // 2^25, bins
const uint kMostPeaks = 256u;       // of .4 % each: more there cannot be
shared uint peak_count, peaks[kMostPeaks];
shared uint mode_count, mode_peak[kSlots], mode_slot[kSlots];
shared vec2 mode_center[kSlots];

float mass_of(uint bin) { return float(LOAD(words, kBins + bin)); }

void smooth_into(uint from, uint to, int step) {
  for (uint b = gl_LocalInvocationIndex; b < kBins; b += gl_WorkGroupSize.x) {
    int along = step == 1 ? int(b % kSide) : int(b / kSide);
    float sum = 0.0, all = 0.0;
    for (int d = -kReach; d <= kReach; ++d) {
      float w = exp(-0.5 * float(d * d) / (kSigma * kSigma));
      all += w;
      if (along + d >= 0 && along + d < int(kSide)) {
        uint at = uint(int(b) + d * step);
        sum += w * (from == 2u ? LOAD(carried, at) : LOAD(heights, from * kBins + at));
      }
    }
    LOAD(heights, to * kBins + b) = sum / all;
  }
}

void statistics() {
  vec4 sum = vec4(0.0);  // |t|^2, f^2, w |t|^2, w
  for (uint i = gl_LocalInvocationIndex; i < push.count; i += gl_WorkGroupSize.x) {
    vec4 at = FETCH(lit, int(i));
    float tint = dot(at.xy, at.xy);
    sum += vec4(tint, at.z * at.z, at.w * tint, at.w);
  }
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationIndex != 0u) return;
  float scene_tint = sum.z / (sum.w + 1e-9);
  LOAD(scene, SCENE_STATISTICS) =
      vec4(sqrt(sum.x / (sum.y + 1e-9)), scene_tint / (scene_tint + push.gate), 0.0, 0.0);
}

// The largest modes in falling order of mass, each with a slot: that of the nearest color before, or a free one.
void choose() {
  float least = push.least_share * kMass;
  mode_count = 0u;
  uint found = min(peak_count, kMostPeaks);
  for (uint m = 0u; m < kSlots; ++m) {
    float most = -1.0;
    uint best = 0u;
    for (uint p = 0u; p < found; ++p) {
      uint bin = peaks[p];
      float mass = mass_of(bin);
      bool taken = false;
      for (uint k = 0u; k < mode_count; ++k) taken = taken || mode_peak[k] == bin;
      if (!taken && mass >= least && (mass > most || (mass == most && bin < best))) {
        most = mass;
        best = bin;
      }
    }
    if (most <= 0.0) break;
    mode_peak[m] = best;
    mode_center[m] = kBinWidth * kMass / kMoment / most *
                     vec2(int(LOAD(words, 2u * kBins + best)), int(LOAD(words, 3u * kBins + best)));
    mode_count = m + 1u;
  }
  if (mode_count == 0u) {
    mode_peak[0] = bin_at(vec2(0.0));
    mode_center[0] = vec2(0.0);
    mode_count = 1u;
  }
  uint taken = 0u;
  bool anew = LOAD(scene, SCENE_STATE).x > 0.0;
  for (uint m = 0u; m < mode_count; ++m) {
    float nearest = push.same * push.same;
    mode_slot[m] = kSlots;
    for (uint s = 0u; s < kSlots; ++s) {
      vec4 color = LOAD(base, s);
      vec2 off = color.xy - mode_center[m];
      if (anew || color.z == 0.0 || (taken & (1u << s)) != 0u || dot(off, off) >= nearest) continue;
      nearest = dot(off, off);
      mode_slot[m] = s;
    }
    if (mode_slot[m] < kSlots) taken |= 1u << mode_slot[m];
  }
  for (uint m = 0u; m < mode_count; ++m) {
    if (mode_slot[m] < kSlots) continue;
    mode_slot[m] = uint(findLSB(~taken));
    taken |= 1u << mode_slot[m];
  }
  for (uint s = 0u; s < kSlots; ++s) LOAD(base, s) = vec4(0.0);
  for (uint m = 0u; m < mode_count; ++m) LOAD(base, mode_slot[m]) = vec4(mode_center[m], 1.0, mass_of(mode_peak[m]) / kMass);
  LOAD(base, kSlots) = vec4(mode_count);
}

void main() {
  uint lane = gl_LocalInvocationIndex, lanes = gl_WorkGroupSize.x;
  statistics();
  vec4 sum = vec4(0.0);
  for (uint b = lane; b < kBins; b += lanes) sum.x += float(FETCH1(histogram, int(b)));
  float total = max(workgroup_sum(sum).x, 1.0);
  vec4 state = LOAD(scene, SCENE_STATE);
  for (uint b = lane; b < kBins; b += lanes) {
    float before = state.x > 0.0 ? 0.0 : LOAD(carried, b), now = float(FETCH1(histogram, int(b))) / total;
    LOAD(carried, b) = before + (state.x > 0.0 ? 1.0 : state.w) * (now - before);
    for (uint k = 1u; k < 4u; ++k) LOAD(words, k * kBins + b) = 0u;
  }
  if (lane == 0u) peak_count = 0u;
  memoryBarrierBuffer();
  barrier();
  smooth_into(2u, 0u, 1);
  memoryBarrierBuffer();
  barrier();
  smooth_into(0u, 1u, int(kSide));
  memoryBarrierBuffer();
  barrier();
  for (uint b = lane; b < kBins; b += lanes) {
    ivec2 at = ivec2(b % kSide, b / kSide), low = max(at - 1, 0), high = min(at + 1, int(kSide) - 1);
    uint best = b;
    float height = LOAD(heights, kBins + b);
    for (int v = low.y; v <= high.y; ++v)
      for (int u = low.x; u <= high.x; ++u) {
        uint other = uint(v) * kSide + uint(u);
        float there = LOAD(heights, kBins + other);
        if (there > height || (there == height && other < best)) {
          height = there;
          best = other;
        }
      }
    LOAD(words, b) = best;
  }
  memoryBarrierBuffer();
  barrier();
  // The peak of every bin: nobody changes who climbs where, so that no bin sees another's shortcut.
  for (uint b = lane; b < kBins; b += lanes) {
    float mass = LOAD(carried, b);
    if (mass <= 0.0) continue;
    uint peak = b;
    for (uint k = 0u; k < kSide; ++k) {
      uint next = LOAD(words, peak);
      if (next == peak) break;
      peak = next;
    }
    vec2 center = bin_center(b) / kBinWidth;
    atomicAdd(LOAD(words, kBins + peak), uint(kMass * mass));
    atomicAdd(LOAD(words, 2u * kBins + peak), uint(int(round(kMoment * mass * center.x))));
    atomicAdd(LOAD(words, 3u * kBins + peak), uint(int(round(kMoment * mass * center.y))));
  }
  memoryBarrierBuffer();
  barrier();
  for (uint b = lane; b < kBins; b += lanes)
    if (mass_of(b) >= push.least_share * kMass && mass_of(b) > 0.0) {
      uint p = atomicAdd(peak_count, 1u);
      if (p < kMostPeaks) peaks[p] = b;
    }
  barrier();
  if (lane == 0u) choose();
  barrier();
  for (uint b = lane; b < kBins; b += lanes) {
    uint peak = b;
    for (uint k = 0u; k < kSide; ++k) {
      uint next = LOAD(words, peak);
      if (next == peak) break;
      peak = next;
    }
    uint owner = kSlots, near = 0u;
    float nearest = 1e30;
    for (uint m = 0u; m < mode_count; ++m) {
      if (mode_peak[m] == peak) owner = m;
      vec2 off = mode_center[m] - bin_center(b);
      if (dot(off, off) < nearest) {
        nearest = dot(off, off);
        near = m;
      }
    }
    STORE(table, b, mode_slot[owner < kSlots ? owner : near]);
  }
}
