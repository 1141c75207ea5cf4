// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "frame.glsl"
#include "transfer.glsl"

// RGB and gray frames to linear RGB, alpha in w. Each invocation converts a strip of 4 x ROWS pixels; each color
// component of four pixels is one vec4.
layout(constant_id = 2) const uint PIXEL = 4u;  // bytes: 1 gray8, 2 gray16, 3 rgb, 4 rgba, 8 rgba64
layout(constant_id = 3) const bool BGR = false;
layout(constant_id = 4) const bool ALPHA = true;
WORD_IN(0, raw);
PLANE_OUT(1, linear);

uint word(uint row, uint index) { return FETCH1(raw, word_index(0u, row, index)); }

void store(uint at, uint count, vec4 r, vec4 g, vec4 b, vec4 a) {
  if (count > 0u) STORE(linear, BY_ROWS(at), vec4(r.x, g.x, b.x, a.x));
  if (count > 1u) STORE(linear, BY_ROWS(at + 1u), vec4(r.y, g.y, b.y, a.y));
  if (count > 2u) STORE(linear, BY_ROWS(at + 2u), vec4(r.z, g.z, b.z, a.z));
  if (count > 3u) STORE(linear, BY_ROWS(at + 3u), vec4(r.w, g.w, b.w, a.w));
}

vec4 light(uvec4 code) {
  vec4 value = (vec4(code) - push.codes.x) * push.codes.y;
  return decode(clamp(value, 0.0, push.ceiling), push.curve, push.power);
}

void main() {
  uvec2 place = gl_GlobalInvocationID.xy;
  uint block = place.x;
  if (block * 4u >= push.size.x) return;
  uint count = push.size.x - block * 4u;
  uint first = push.first_row + place.y * ROWS;
  uint last = min(first + ROWS, push.size.y);
  for (uint row = first; row < last; ++row) {
    uvec4 r, g, b, a;
    if (PIXEL == 1u) {
      r = g = b = bytes_of(word(row, block));
    } else if (PIXEL == 2u) {
      r = g = b = uvec4(halves_of(word(row, block * 2u)), halves_of(word(row, block * 2u + 1u)));
    } else if (PIXEL == 3u) {
      uvec4 x = bytes_of(word(row, block * 3u));
      uvec4 y = bytes_of(word(row, block * 3u + 1u));
      uvec4 z = bytes_of(word(row, block * 3u + 2u));
      r = uvec4(x.x, x.w, y.z, z.y);
      g = uvec4(x.y, y.x, y.w, z.z);
      b = uvec4(x.z, y.y, z.x, z.w);
    } else if (PIXEL == 4u) {
      uvec4 w = uvec4(word(row, block * 4u), word(row, block * 4u + 1u), word(row, block * 4u + 2u),
                      word(row, block * 4u + 3u));
      r = w & 255u;
      g = w >> 8 & 255u;
      b = w >> 16 & 255u;
      a = w >> 24;
    } else {
      uvec4 low = uvec4(word(row, block * 8u), word(row, block * 8u + 2u), word(row, block * 8u + 4u),
                        word(row, block * 8u + 6u));
      uvec4 high = uvec4(word(row, block * 8u + 1u), word(row, block * 8u + 3u), word(row, block * 8u + 5u),
                         word(row, block * 8u + 7u));
      r = low & 65535u;
      g = low >> 16;
      b = high & 65535u;
      a = high >> 16;
    }
    vec4 alpha = ALPHA ? vec4(a) * (PIXEL == 8u ? 1.0 / 65535.0 : 1.0 / 255.0) : vec4(1.0);
    uint at = row * push.size.x + block * 4u;
    vec4 red = light(r);
    if (PIXEL <= 2u) {
      store(at, count, red, red, red, alpha);
    } else {
      vec4 green = light(g), blue = light(b);
      if (BGR) store(at, count, blue, green, red, alpha);
      else store(at, count, red, green, blue, alpha);
    }
  }
}
