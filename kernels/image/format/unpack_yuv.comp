// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "frame.glsl"
#include "transfer.glsl"
#include "yuv.glsl"

// Y'CbCr frames to linear RGB, w = 1. Each invocation converts a strip of 4 pixels x PAIRS pairs of rows and reuses
// chroma rows from pair to pair; each component of four pixels is one vec4.
const uint PAIRS = ROWS / 2u;
WORD_IN(0, raw);
PLANE_OUT(1, linear);

uint word(uint plane, uint row, uint index) { return FETCH1(raw, word_index(plane, row, index)); }
uvec2 codes_of(uint word) { return (halves_of(word) >> SHIFT) & 1023u; }

vec4 luma(uint row, uint block) {
  uvec4 code;
  if (PACKED) {
    uvec4 a = bytes_of(word(0u, row, block * 2u)), b = bytes_of(word(0u, row, block * 2u + 1u));
    code = LAYOUT == kYuy2 ? uvec4(a.xz, b.xz) : uvec4(a.yw, b.yw);
  } else if (DEEP) {
    code = uvec4(codes_of(word(0u, row, block * 2u)), codes_of(word(0u, row, block * 2u + 1u)));
  } else {
    code = bytes_of(word(0u, row, block));
  }
  return (vec4(code) - push.codes.x) * push.codes.y;
}

// The two samples (Cb, Cr, Cb, Cr) of a chroma row at columns 2 pair and 2 pair + 1.
uvec4 pair_at(uint row, uint pair) {
  if (PACKED) {
    uvec4 a = bytes_of(word(0u, row, pair * 2u)), b = bytes_of(word(0u, row, pair * 2u + 1u));
    return LAYOUT == kYuy2 ? uvec4(a.yw, b.yw) : uvec4(a.xz, b.xz);
  }
  if (LAYOUT == kSemiPlanar) {
    if (DEEP) return uvec4(codes_of(word(1u, row, pair * 2u)), codes_of(word(1u, row, pair * 2u + 1u)));
    return bytes_of(word(1u, row, pair));
  }
  uvec2 cb_cr = uvec2(word(1u, row, DEEP ? pair : pair / 2u), word(2u, row, DEEP ? pair : pair / 2u));
  if (DEEP) return uvec4(codes_of(cb_cr.x), codes_of(cb_cr.y)).xzyw;
  cb_cr >>= (pair & 1u) * 16u;
  return uvec4(cb_cr & 255u, cb_cr >> 8 & 255u);
}

// Chroma of the four pixels of a block from one chroma row; edges repeat.
struct Chroma { vec4 cb, cr; };
Chroma chroma(uint row, uint block) {
  uint count = (push.size.x + 1u) / 2u - block * 2u;  // samples from here to the right edge
  uvec4 own = pair_at(row, block);
  uvec2 left = own.xy, right = pair_at(row, block + 1u).xy;
  if (!COSITED_X) {
    left = pair_at(row, max(block, 1u) - 1u).zw;
    left = mix(left, own.xy, bvec2(block == 0u));
  }
  own.zw = mix(own.zw, own.xy, bvec2(count < 2u));
  right = mix(right, own.zw, bvec2(count < 3u));
  return Chroma((upsample(vec4(left.x, own.x, own.z, right.x)) - push.codes.z) * push.codes.w,
                (upsample(vec4(left.y, own.y, own.w, right.y)) - push.codes.z) * push.codes.w);
}

vec4 light(vec4 value) { return decode(clamp(value, 0.0, push.ceiling), push.curve, push.power); }

void draw(uint row, uint block, vec4 cb, vec4 cr) {
  vec4 y = luma(row, block);
  vec4 r = light(y + push.matrix.x * cr);
  vec4 g = light(y + push.matrix.y * cb + push.matrix.z * cr);
  vec4 b = light(y + push.matrix.w * cb);
  uint at = row * push.size.x + block * 4u;
  uint count = push.size.x - block * 4u;
  STORE(linear, BY_ROWS(at), vec4(r.x, g.x, b.x, 1.0));
  if (count > 1u) STORE(linear, BY_ROWS(at + 1u), vec4(r.y, g.y, b.y, 1.0));
  if (count > 2u) STORE(linear, BY_ROWS(at + 2u), vec4(r.z, g.z, b.z, 1.0));
  if (count > 3u) STORE(linear, BY_ROWS(at + 3u), vec4(r.w, g.w, b.w, 1.0));
}

void main() {
  uvec2 place = gl_GlobalInvocationID.xy;
  uint block = place.x;
  if (block * 4u >= push.size.x) return;
  uint first = push.first_row / 2u + place.y * PAIRS;
  uint rows = (push.size.y + 1u) / 2u;
  uint end = min(first + PAIRS, rows);
  if (PACKED) {
    for (uint row = first * 2u; row < min(end * 2u, push.size.y); ++row) {
      Chroma own = chroma(row, block);
      draw(row, block, own.cb, own.cr);
    }
    return;
  }
  Chroma own = chroma(first, block);
  Chroma above = own;
  if (!COSITED_Y) above = chroma(max(first, 1u) - 1u, block);
  for (uint row = first; row < end; ++row) {
    Chroma below = chroma(min(row + 1u, rows - 1u), block);
    float weight = COSITED_Y ? 0.0 : 0.25;
    draw(row * 2u, block, mix(own.cb, above.cb, weight), mix(own.cr, above.cr, weight));
    weight = COSITED_Y ? 0.5 : 0.25;
    if (row * 2u + 1u < push.size.y)
      draw(row * 2u + 1u, block, mix(own.cb, below.cb, weight), mix(own.cr, below.cr, weight));
    above = own;
    own = below;
  }
}
