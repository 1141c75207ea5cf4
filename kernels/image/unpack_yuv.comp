#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "frame.glsl"
#include "transfer.glsl"
#include "yuv.glsl"

// Y'CbCr frames to linear RGB, w = 1. Each invocation turns a strip of 4 pixels x PAIRS pairs of rows, carrying the
// chroma rows down; values are held component by component, four pixels in a vec4.
const uint PAIRS = 2u;
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

// The sample (Cb, Cr) at a column of a chroma row.
uvec2 sample_at(uint row, uint column) {
  if (PACKED) {
    uvec4 b = bytes_of(word(0u, row, column));
    return LAYOUT == kYuy2 ? b.yw : b.xz;
  }
  if (LAYOUT == kSemiPlanar) {
    if (DEEP) return codes_of(word(1u, row, column));
    uint pair = word(1u, row, column >> 1) >> ((column & 1u) * 16u);
    return uvec2(pair, pair >> 8) & 255u;
  }
  uint index = DEEP ? column >> 1 : column >> 2;
  uint shift = DEEP ? (column & 1u) * 16u + SHIFT : (column & 3u) * 8u;
  return (uvec2(word(1u, row, index), word(2u, row, index)) >> shift) & (DEEP ? 1023u : 255u);
}

struct Chroma { vec4 cb, cr; };
Chroma chroma(uint row, uint block) {
  uint last = (push.size.x - 1u) / 2u;
  uvec4 column = min(uvec4(max(block * 2u, 1u) - 1u, block * 2u, block * 2u + 1u, block * 2u + 2u), uvec4(last));
  uvec2 b = sample_at(row, column.y), c = sample_at(row, column.z), d = sample_at(row, column.w);
  uvec2 a = COSITED_X ? b : sample_at(row, column.x);
  return Chroma((upsample(vec4(a.x, b.x, c.x, d.x)) - push.codes.z) * push.codes.w,
                (upsample(vec4(a.y, b.y, c.y, d.y)) - push.codes.z) * push.codes.w);
}

vec4 light(vec4 value) { return decode(clamp(value, 0.0, push.ceiling), push.curve, push.power); }

void draw(uint row, uint block, vec4 cb, vec4 cr) {
  if (row >= push.size.y) return;
  vec4 y = luma(row, block);
  vec4 r = light(y + push.matrix.x * cr);
  vec4 g = light(y + push.matrix.y * cb + push.matrix.z * cr);
  vec4 b = light(y + push.matrix.w * cb);
  uint at = row * push.size.x + block * 4u;
  uint count = push.size.x - block * 4u;
  STORE(linear, at, vec4(r.x, g.x, b.x, 1.0));
  if (count > 1u) STORE(linear, at + 1u, vec4(r.y, g.y, b.y, 1.0));
  if (count > 2u) STORE(linear, at + 2u, vec4(r.z, g.z, b.z, 1.0));
  if (count > 3u) STORE(linear, at + 3u, vec4(r.w, g.w, b.w, 1.0));
}

void main() {
  uint block = gl_GlobalInvocationID.x;
  if (block * 4u >= push.size.x) return;
  uint first = gl_GlobalInvocationID.y * PAIRS;
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
    if (COSITED_Y) {
      draw(row * 2u, block, own.cb, own.cr);
      draw(row * 2u + 1u, block, 0.5 * (own.cb + below.cb), 0.5 * (own.cr + below.cr));
    } else {
      draw(row * 2u, block, mix(own.cb, above.cb, 0.25), mix(own.cr, above.cr, 0.25));
      draw(row * 2u + 1u, block, mix(own.cb, below.cb, 0.25), mix(own.cr, below.cr, 0.25));
    }
    above = own;
    own = below;
  }
}
