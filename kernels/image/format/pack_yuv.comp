// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "gpu/common.glsl"
#include "frame.glsl"
#include "transfer.glsl"
#include "draw.glsl"
#include "yuv.glsl"

// A plane to Y'CbCr frames. Each invocation writes the whole words of a block of 4 x 2 pixels, or 8 x 2 if four chroma
// samples share a word. Pixels beyond the right edge repeat the last one.
const uint PAIRS = ROWS / 2u;
const uint BLOCKS = LAYOUT == kPlanar && !DEEP ? 2u : 1u;
WORD_OUT(1, raw);

void store(uint plane, uint row, uint index, uint word) {
  STORE(raw, push.offset[plane] + (row - push.first_row) * push.stride[plane] + index, word);
}

vec4 luma(Pack q) {
  return push.matrix.x * q.r + (1.0 - push.matrix.x - push.matrix.y) * q.g + push.matrix.y * q.b;
}

uvec2 chroma_code(vec2 value) { return code_of(value.xyxy, push.codes.z, push.codes.w).xy; }

void store_luma(uint row, uint x, vec4 y) {
  uvec4 code = code_of(y, push.codes.x, push.codes.y);
  if (DEEP) {
    code <<= SHIFT;
    store(0u, row, x / 2u, word_of_halves(code.xy));
    if (x + 2u < push.size.x) store(0u, row, x / 2u + 1u, word_of_halves(code.zw));
  } else {
    store(0u, row, x / 4u, word_of_bytes(code));
  }
}

void store_packed(uint row, uint x, vec4 y, vec2 cb, vec2 cr) {
  uvec4 code = code_of(y, push.codes.x, push.codes.y);
  uvec2 u = chroma_code(cb), v = chroma_code(cr);
  uvec4 left = uvec4(code.x, u.x, code.y, v.x), right = uvec4(code.z, u.y, code.w, v.y);
  if (LAYOUT == kUyvy) {
    left = left.yxwz;
    right = right.yxwz;
  }
  store(0u, row, x / 2u, word_of_bytes(left));
  if (x + 2u < push.size.x) store(0u, row, x / 2u + 1u, word_of_bytes(right));
}

// Writes a row of four pixels (if `own`) and returns its contribution to their two chroma samples.
struct Chroma { vec2 cb, cr; };
Chroma draw(uint row, uint x, bool own) {
  Pack pack = pack_at(row, x);
  vec4 y = luma(pack);
  vec2 left = vec2(0.0);  // of the pixel left of the four
  if (COSITED_X) {
    vec4 pixel = color_at(row, max(x, 1u) - 1u);
    Pack beside = encoded(pixel.xxxx, pixel.yyyy, pixel.zzzz);
    left = vec2(beside.b.x, beside.r.x) - luma(beside).x;
  }
  Chroma chroma = Chroma(downsample(left.x, pack.b - y) * push.matrix.z, downsample(left.y, pack.r - y) * push.matrix.w);
  if (own && PACKED) store_packed(row, x, y, chroma.cb, chroma.cr);
  if (own && !PACKED) store_luma(row, x, y);
  return chroma;
}

void store_chroma(uint pair, uint first, uvec4 u, uvec4 v) {
  if (LAYOUT == kSemiPlanar) {
    if (DEEP) {
      store(1u, pair, first / 2u, word_of_halves(uvec2(u.z, v.z)));
      if (first + 2u < push.size.x) store(1u, pair, first / 2u + 1u, word_of_halves(uvec2(u.w, v.w)));
    } else {
      store(1u, pair, first / 4u, word_of_bytes(uvec4(u.z, v.z, u.w, v.w)));
    }
  } else if (DEEP) {
    store(1u, pair, first / 4u, word_of_halves(u.zw));
    store(2u, pair, first / 4u, word_of_halves(v.zw));
  } else {
    store(1u, pair, first / 8u, word_of_bytes(u));
    store(2u, pair, first / 8u, word_of_bytes(v));
  }
}

void main() {
  uvec2 place = gl_GlobalInvocationID.xy;
  uint first = place.x * BLOCKS * 4u;
  if (first >= push.size.x) return;
  uint begin = push.first_row / 2u + place.y * PAIRS;
  uint end = min(begin + PAIRS, (push.size.y + 1u) / 2u);
  for (uint pair = begin; pair < end; ++pair) {
    uint row = pair * 2u;
    bool whole = row + 1u < push.size.y;
    vec4 cb = vec4(0.0), cr = vec4(0.0);  // of up to four samples
    [[unroll]] for (uint block = 0u; block < BLOCKS; ++block) {
      uint x = first + block * 4u;
      bool own = x < push.size.x;
      Chroma upper = draw(row, x, own);
      Chroma lower = draw(whole ? row + 1u : row, x, own && whole);
      vec2 sum_cb = 0.5 * (upper.cb + lower.cb), sum_cr = 0.5 * (upper.cr + lower.cr);
      if (COSITED_Y) {
        Chroma above = draw(max(row, 1u) - 1u, x, false);
        sum_cb = 0.5 * upper.cb + 0.25 * (above.cb + lower.cb);
        sum_cr = 0.5 * upper.cr + 0.25 * (above.cr + lower.cr);
      }
      cb = vec4(cb.zw, sum_cb);
      cr = vec4(cr.zw, sum_cr);
    }
    if (!PACKED)
      store_chroma(pair, first, code_of(cb, push.codes.z, push.codes.w) << SHIFT,
                   code_of(cr, push.codes.z, push.codes.w) << SHIFT);
  }
}
