// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "global/model/model.glsl"
#include "global/model/counts.glsl"

// One workgroup: base colors are the modes of the histogram of chroma. Averages the histogram over time, smooths it, climbs from
// every bin to its peak, and selects the peaks of most mass; each keeps the slot of the color that it continues. A color whose peak
// is gone stays for some frames, in the basin that it is now in, and keeps its slot for more. Reads its own output, and so uses
// storage buffers.
WORD_IN(0, counts);
PLANE_INOUT(1, scene);
WORD_OUT(2, slots);  // of bins
layout(set = 0, binding = 3, std430) coherent restrict buffer histogram_block { float histogram_data[]; };
layout(set = 0, binding = 4, std430) coherent restrict buffer heights_block { float heights_data[]; };  // 2 kBinCount
layout(set = 0, binding = 5, std430) coherent restrict buffer work_block { int work_data[]; };
layout(push_constant) uniform Push {
  float smoothing;    // standard deviation, bins
  float min_share;  // of all mass, for a mode to count
  float same;         // chroma up to which a mode continues a color of before
  float follow;       // share of the newest frame in a color's usual place
  int max_colors;
  int keep, forget;   // frames that a color without a mode stays, and keeps its slot
} push;

// Of work: every bin's peak; of peaks, the mass of their basin and its moments about them, in fixed point; a list.
const int kPeak = 0, kMass = kBinCount, kMoment = 2 * kBinCount, kList = 4 * kBinCount, kListed = kList + 1;
const float kMassUnit = 16777216.0, kMomentUnit = 4194304.0;
const int kMaxListed = 1024;
const int kReach = 8;   // of the smoothing, bins
const int kAround = 2;  // bins around a color's usual place in which it counts as present

#define SYNC memoryBarrierBuffer(); barrier()
#define EVERY_BIN(b) for (int b = int(gl_LocalInvocationID.x); b < kBinCount; b += int(gl_WorkGroupSize.x))

shared vec4 modes[kSlots];  // center, mass, slot
shared int mode_peaks[kSlots];
shared int mode_count;

float smoothed(int b, int from, int step, int along) {
  int reach = min(int(ceil(3.0 * push.smoothing)), kReach);
  float sum = 0.0, all = 0.0, narrow = -0.5 / (push.smoothing * push.smoothing);
  for (int d = -reach; d <= reach; ++d) {
    float w = exp(narrow * float(d * d));
    all += w;
    if (along + d >= 0 && along + d < kBins)
      sum += w * (from < 0 ? LOAD(histogram, b + d * step) : LOAD(heights, from + b + d * step));
  }
  return sum / all;
}

float mass_around(vec2 chroma) {
  int at = bin_of(chroma);
  ivec2 middle = ivec2(at & (kBins - 1), at / kBins), low = max(middle - kAround, 0), high = min(middle + kAround, kBins - 1);
  float sum = 0.0;
  for (int y = low.y; y <= high.y; ++y)
    for (int x = low.x; x <= high.x; ++x) sum += LOAD(histogram, y * kBins + x);
  return sum;
}

// Gives modes the slots of the colors that they continue, nearest pairs first, and other modes a free slot, or that of the color
// that was absent for longest; adds the colors that stay without a mode.
void keep_slots(float all) {
  bool restart = LOAD(scene, SCENE_TIME)[TIME_FRAMES] < 1.5;
  uint free = (1u << push.max_colors) - 1u;
  for (int s = 0; s < kSlots; ++s)
    if (restart || s >= push.max_colors) LOAD(scene, SCENE_MEMORY + s) = vec4(0.0);
  for (int pair = 0; pair < mode_count; ++pair) {
    float nearest = push.same * push.same;
    int mode = -1, slot = -1;
    for (int m = 0; m < mode_count; ++m)
      for (int s = 0; s < push.max_colors; ++s) {
        vec4 memory = LOAD(scene, SCENE_MEMORY + s);
        vec2 off = memory.xy - modes[m].xy;
        if (modes[m].w < 0.0 && (free & (1u << s)) != 0u && memory.z > 0.0 && dot(off, off) < nearest) {
          nearest = dot(off, off);
          mode = m;
          slot = s;
        }
      }
    if (mode < 0) break;
    modes[mode].w = float(slot);
    free &= ~(1u << slot);
  }
  int seen = mode_count;
  for (int s = 0; s < push.max_colors; ++s) {
    vec4 memory = LOAD(scene, SCENE_MEMORY + s);
    if ((free & (1u << s)) == 0u || memory.z == 0.0) continue;
    memory.w += 1.0;
    LOAD(scene, SCENE_MEMORY + s) = memory.w > float(push.forget) ? vec4(0.0) : memory;
    float left = mass_around(memory.xy);
    if (memory.w > float(push.keep) || mode_count == push.max_colors || left < 0.5 * push.min_share * all) continue;
    modes[mode_count] = vec4(memory.xy, left, float(s));
    mode_peaks[mode_count++] = LOAD(work, kPeak + bin_of(memory.xy));
    free &= ~(1u << s);
  }
  for (int m = 0; m < seen; ++m) {
    if (modes[m].w < 0.0) {
      int slot = -1;
      float longest = -1.0;
      for (int s = push.max_colors - 1; s >= 0; --s) {
        vec4 memory = LOAD(scene, SCENE_MEMORY + s);
        float away = memory.z == 0.0 ? 3e38 : memory.w;
        if ((free & (1u << s)) != 0u && away >= longest) {
          longest = away;
          slot = s;
        }
      }
      modes[m].w = float(slot);
      free &= ~(1u << slot);
      LOAD(scene, SCENE_MEMORY + slot) = vec4(modes[m].xy, 1.0, 0.0);
    }
    int at = SCENE_MEMORY + int(modes[m].w);
    LOAD(scene, at) = vec4(mix(LOAD(scene, at).xy, modes[m].xy, push.follow), 1.0, 0.0);
  }
}

// Modes in falling order of mass: every invocation places the peaks that it lists.
void rank_modes() {
  int count = min(LOAD(work, kList), kMaxListed);
  for (int l = int(gl_LocalInvocationID.x); l < count; l += int(gl_WorkGroupSize.x)) {
    int peak = LOAD(work, kListed + l), mass = LOAD(work, kMass + peak), rank = 0;
    for (int o = 0; o < count && rank < push.max_colors; ++o) {
      int other = LOAD(work, kListed + o), others = LOAD(work, kMass + other);
      rank += int(others > mass || (others == mass && other < peak));
    }
    if (rank >= push.max_colors) continue;
    float share = float(mass) / kMassUnit;
    vec2 moment = vec2(LOAD(work, kMoment + 2 * peak), LOAD(work, kMoment + 2 * peak + 1)) / kMomentUnit;
    modes[rank] = vec4(bin_center(peak) + moment / share, share, -1.0);
    mode_peaks[rank] = peak;
  }
  if (gl_LocalInvocationID.x == 0u) mode_count = min(count, push.max_colors);
}

// The slots of the modes.
void choose(float all) {
  if (mode_count == 0) {
    modes[0] = vec4(0.0, 0.0, 0.0, -1.0);
    mode_peaks[0] = bin_of(vec2(0.0));
    mode_count = 1;
  }
  keep_slots(all);
  bool usable = LOAD(scene, SCENE_TINT)[TINT_USABLE] > 0.0;
  for (int s = 0; s < kSlots; ++s) LOAD(scene, SCENE_COLORS + s) = vec4(0.0);
  for (int m = 0; m < mode_count; ++m) LOAD(scene, SCENE_COLORS + int(modes[m].w)) = vec4(modes[m].xy, 1.0, modes[m].z) * float(usable);
  LOAD(scene, SCENE_AMOUNT)[AMOUNT_COLORS] = usable ? float(mode_count) : 0.0;
}

void main() {
  vec4 sum = vec4(0.0);
  EVERY_BIN(b) sum.x += float(FETCH1(counts, b)) / kCountUnit;
  float scale = 1.0 / max(workgroup_sum(sum).x, 1e-9);
  sum = vec4(0.0);
  float renew = LOAD(scene, SCENE_TIME)[TIME_SHARE];
  EVERY_BIN(b) {
    float now = scale * float(FETCH1(counts, b)) / kCountUnit;
    now = mix(LOAD(histogram, b), now, renew);
    LOAD(histogram, b) = now;
    LOAD(work, kMass + b) = LOAD(work, kMoment + 2 * b) = LOAD(work, kMoment + 2 * b + 1) = 0;
    sum.x += now;
  }
  if (gl_LocalInvocationID.x == 0u) LOAD(work, kList) = 0;
  float all = workgroup_sum(sum).x;
  SYNC;
  EVERY_BIN(b) LOAD(heights, b) = smoothed(b, -1, 1, b & (kBins - 1));
  SYNC;
  EVERY_BIN(b) LOAD(heights, kBinCount + b) = smoothed(b, 0, kBins, b / kBins);
  SYNC;
  EVERY_BIN(b) {
    ivec2 at = ivec2(b & (kBins - 1), b / kBins), low = max(at - 1, 0), high = min(at + 1, kBins - 1);
    int best = b;
    float max_mass = LOAD(heights, kBinCount + b);
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        float height = LOAD(heights, kBinCount + y * kBins + x);
        if (height > max_mass) {
          max_mass = height;
          best = y * kBins + x;
        }
      }
    LOAD(work, kPeak + b) = best;
  }
  SYNC;
  // Follows the bins ahead, so that their order does not matter.
  for (int k = 0; k < 6; ++k) {
    EVERY_BIN(b) LOAD(work, kPeak + b) = LOAD(work, kPeak + LOAD(work, kPeak + b));
    SYNC;
  }
  EVERY_BIN(b) {
    float mass = LOAD(histogram, b);
    if (mass > 0.0) {
      int peak = LOAD(work, kPeak + b);
      vec2 off = mass * (bin_center(b) - bin_center(peak));
      atomicAdd(LOAD(work, kMass + peak), int(mass * kMassUnit + 0.5));
      atomicAdd(LOAD(work, kMoment + 2 * peak), int(floor(off.x * kMomentUnit + 0.5)));
      atomicAdd(LOAD(work, kMoment + 2 * peak + 1), int(floor(off.y * kMomentUnit + 0.5)));
    }
  }
  SYNC;
  EVERY_BIN(b) {
    float mass = float(LOAD(work, kMass + b)) / kMassUnit;
    if (mass > 0.0 && mass >= push.min_share * all) {
      int place = atomicAdd(LOAD(work, kList), 1);
      if (place < kMaxListed) LOAD(work, kListed + place) = b;
    }
  }
  SYNC;
  rank_modes();
  barrier();
  if (gl_LocalInvocationID.x == 0u) choose(all);
  barrier();
  EVERY_BIN(b) {
    int peak = LOAD(work, kPeak + b), best = -1, nearest = 0;
    float min_distance = 3e38;
    float min_here = 3e38;
    for (int m = 0; m < mode_count; ++m) {
      vec2 off = modes[m].xy - bin_center(b);
      if (mode_peaks[m] == peak && dot(off, off) < min_here) {
        min_here = dot(off, off);
        best = m;
      }
      if (dot(off, off) < min_distance) {
        min_distance = dot(off, off);
        nearest = m;
      }
    }
    STORE(slots, b, uint(modes[best < 0 ? nearest : best].w));
  }
}
