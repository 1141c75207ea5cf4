// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "camera/camera.glsl"
#include "touch.glsl"

// The touch of a frame: the sums of the 3 x 3 tiles that have most weight, the first ones of equals. An arm comes from outside of the
// picture: only tiles count that tiles with some pixels in front connect with its border. One workgroup.
PLANE_IN(0, sums);
PLANE_IN(1, pose);
PLANE_OUT(2, touch);
WORD_OUT(3, arm);
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 tiles;
} push;

shared vec2 best_of[256];  // weight, tile
shared uint reached[TOUCH_ARM_WORDS];
shared uint grows;

vec4 around(uint tile, int slot) {
  ivec2 at = ivec2(tile % push.tiles.x, tile / push.tiles.x), last = ivec2(push.tiles) - 1;
  vec4 sum = vec4(0.0);
  for (int y = max(at.y - 1, 0); y <= min(at.y + 1, last.y); ++y)
    for (int x = max(at.x - 1, 0); x <= min(at.x + 1, last.x); ++x) sum += FETCH(sums, TOUCH_STRIDE * (y * int(push.tiles.x) + x) + slot);
  return sum;
}

const uint kTiles = 32u * TOUCH_ARM_WORDS;
bool is_reached(uint tile) { return tile >= kTiles || (reached[tile >> 5] >> (tile & 31u) & 1u) != 0u; }
bool reached_around(uint tile) {
  ivec2 at = ivec2(tile % push.tiles.x, tile / push.tiles.x), last = ivec2(push.tiles) - 1;
  bool result = false;
  for (int y = max(at.y - 1, 0); y <= min(at.y + 1, last.y); ++y)
    for (int x = max(at.x - 1, 0); x <= min(at.x + 1, last.x); ++x) result = result || is_reached(uint(y * int(push.tiles.x) + x));
  return result;
}

// Floods tiles that have at least four pixels in front, from those at the border of the picture on.
void reach(uint count, uint own) {
  for (uint i = own; i < TOUCH_ARM_WORDS; i += gl_WorkGroupSize.x) reached[i] = 0u;
  for (uint pass = 0u; pass <= count; ++pass) {
    barrier();
    if (own == 0u) grows = 0u;
    barrier();
    for (uint tile = own; tile < min(count, kTiles); tile += gl_WorkGroupSize.x) {
      uvec2 at = uvec2(tile % push.tiles.x, tile / push.tiles.x);
      bool border = any(equal(at, uvec2(0u))) || any(equal(at + 1u, push.tiles));
      if (is_reached(tile) || FETCH(sums, int(TOUCH_STRIDE * tile) + 2).z < 4.0 || !(border || reached_around(tile))) continue;
      atomicOr(reached[tile >> 5], 1u << (tile & 31u));
      grows = 1u;
    }
    barrier();
    if (grows == 0u) break;
  }
}

void main() {
  uint count = push.tiles.x * push.tiles.y, own = gl_LocalInvocationIndex;
  reach(count, own);
  for (uint word = own; word < TOUCH_ARM_WORDS && 32u * word < count; word += gl_WorkGroupSize.x) {
    uint bits = 0u;
    for (uint bit = 0u; bit < min(count - 32u * word, 32u); ++bit) bits |= uint(reached_around(32u * word + bit)) << bit;
    STORE(arm, word, bits);
  }
  vec2 best = vec2(0.0);
  vec4 all = vec4(0.0);
  for (uint tile = own; tile < count; tile += gl_WorkGroupSize.x) {
    all += FETCH(sums, int(TOUCH_STRIDE * tile) + 2);
    float weight = reached_around(tile) ? around(tile, 0).w : 0.0;
    if (weight > best.x) best = vec2(weight, tile);
  }
  all = workgroup_sum(all);
  best_of[own] = best;
  barrier();
  if (own != 0u) return;
  for (uint i = 1u; i < gl_WorkGroupSize.x; ++i) {
    vec2 other = best_of[i];
    if (other.x > best.x || (other.x == best.x && other.y < best.y)) best = other;
  }
  vec4 place = around(uint(best.y), 0), color = around(uint(best.y), 1), counts = around(uint(best.y), 2);
  vec3 at = place.xyz / max(place.w, 1e-9);
  float area = place.w * at.z * at.z / abs(push.lens.x * push.lens.y);
  STORE(touch, 0, vec4(to_world(FETCH(pose, 0), FETCH(pose, 1), at), area));
  STORE(touch, 1, vec4(color.rgb / max(color.w, 1e-9), color.w > 0.0));
  STORE(touch, 2, vec4(counts.x / max(place.w, 1e-9), counts.y, all.z / max(all.w, 1.0), 0.0));
}
