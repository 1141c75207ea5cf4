// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "frame.glsl"
#include "transfer.glsl"
#include "draw.glsl"

// A plane to RGB and gray frames. Each invocation writes the whole words of a strip of 4 x ROWS pixels. Pixels beyond
// the right edge that share a word with the last one repeat it.
layout(constant_id = 2) const uint PIXEL = 4u;  // bytes: 1 gray8, 2 gray16, 3 rgb, 4 rgba, 8 rgba64
layout(constant_id = 3) const bool BGR = false;
layout(constant_id = 4) const bool ALPHA = true;
PLANE_IN(1, alpha_plane);
WORD_OUT(2, raw);

void store(uint row, uint index, uint word) {
  STORE(raw, push.offset.x + (row - push.first_row) * push.stride.x + index, word);
}

float alpha_at(uint row, uint column) {
  return FETCH(alpha_plane, int(row * push.size.x + min(column, push.size.x - 1u))).w;
}

void main() {
  uvec2 place = gl_GlobalInvocationID.xy;
  uint block = place.x;
  if (block * 4u >= push.size.x) return;
  uint count = push.size.x - block * 4u;
  uint first = push.first_row + place.y * ROWS;
  uint last = min(first + ROWS, push.size.y);
  for (uint row = first; row < last; ++row) {
    uint x = block * 4u;
    Pack pack = pack_at(row, x);
    if (PIXEL <= 2u) {
      vec4 y = push.matrix.x * pack.r + (1.0 - push.matrix.x - push.matrix.y) * pack.g + push.matrix.y * pack.b;
      uvec4 code = code_of(y, push.codes.x, push.codes.y);
      if (PIXEL == 1u) {
        store(row, block, word_of_bytes(code));
      } else {
        store(row, block * 2u, word_of_halves(code.xy));
        if (count > 2u) store(row, block * 2u + 1u, word_of_halves(code.zw));
      }
      continue;
    }
    uvec4 r = code_of(BGR ? pack.b : pack.r, push.codes.x, push.codes.y);
    uvec4 g = code_of(pack.g, push.codes.x, push.codes.y);
    uvec4 b = code_of(BGR ? pack.r : pack.b, push.codes.x, push.codes.y);
    uvec4 a = uvec4(uint(push.largest));
    if (ALPHA) {
      vec4 alpha = vec4(alpha_at(row, x), alpha_at(row, x + 1u), alpha_at(row, x + 2u), alpha_at(row, x + 3u));
      if ((push.flags & kFlagOpaque) == 0u) a = code_of(sanitized(alpha, 1.0), 0.0, push.largest);
    }
    if (PIXEL == 3u) {
      store(row, block * 3u, word_of_bytes(uvec4(r.x, g.x, b.x, r.y)));
      if (count > 1u) store(row, block * 3u + 1u, word_of_bytes(uvec4(g.y, b.y, r.z, g.z)));
      if (count > 2u) store(row, block * 3u + 2u, word_of_bytes(uvec4(b.z, r.w, g.w, b.w)));
    } else if (PIXEL == 4u) {
      uvec4 word = r | g << 8 | b << 16 | a << 24;
      store(row, x, word.x);
      if (count > 1u) store(row, x + 1u, word.y);
      if (count > 2u) store(row, x + 2u, word.z);
      if (count > 3u) store(row, x + 3u, word.w);
    } else {
      uvec4 low = r | g << 16, high = b | a << 16;
      for (uint i = 0u; i < min(count, 4u); ++i) {
        store(row, (x + i) * 2u, low[i]);
        store(row, (x + i) * 2u + 1u, high[i]);
      }
    }
  }
}
