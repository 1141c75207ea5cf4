// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "gpu/common.glsl"
#include "frame.glsl"
#include "transfer.glsl"
#include "samples.glsl"

// Frames of any described format to linear RGB, alpha in w. Each invocation converts a strip of 4 x ROWS pixels and
// reuses chroma rows from row to row; each component of four pixels is one vec4.
WORD_IN(0, raw);
PLANE_OUT(1, linear);

float code_at(uint c, uint row, uint sample_index) {
  uint at = sample_index * stride_of(c) + offset_of(c);
  uint word = FETCH1(raw, word_index(plane_of(c), row, word_of(at))) >> bit_of(at);
  if (UNIT == kBe16) word = swap16(word & 65535u);
  if (UNIT == kBe32) word = swap32(word);
  return float(word >> shift_of(c) & largest_of(c));
}

vec4 codes_at(uint c, uint row, uint x) {
  return vec4(code_at(c, row, x), code_at(c, row, x + 1u), code_at(c, row, x + 2u), code_at(c, row, x + 3u));
}

// Chroma of four pixels from one chroma row: linear interpolation; edges repeat.
vec4 across(uint c, uint row, uint x) {
  if (W_SUB == 0u) return codes_at(c, row, x);
  const float size = float(1u << W_SUB);
  int first = int(x >> W_SUB), last = int((push.size.x - 1u) >> W_SUB);
  vec4 result;
  [[unroll]] for (int i = 0; i < 4; ++i) {
    float position = (float(i) - (COSITED_X ? 0.0 : 0.5 * (size - 1.0))) / size, low = floor(position);
    float left = code_at(c, row, uint(clamp(first + int(low), 0, last)));
    float right = code_at(c, row, uint(clamp(first + int(low) + 1, 0, last)));
    result[i] = mix(left, right, position - low);
  }
  return result;
}

struct Chroma { vec4 cb, cr; };
Chroma chroma(int row, uint x) {
  uint inside = uint(clamp(row, 0, int((push.size.y - 1u) >> H_SUB)));
  return Chroma(across(1u, inside, x), across(2u, inside, x));
}

vec4 light(vec4 value) { return decode(clamp(value, 0.0, push.ceiling), push.curve, push.power); }
vec4 light_of_codes(vec4 code) { return light((code - push.codes.x) * push.codes.y); }

void main() {
  uvec2 place = gl_GlobalInvocationID.xy;
  uint x = place.x * 4u;
  if (x >= push.size.x) return;
  uint count = push.size.x - x;
  uint first = push.first_row + place.y * ROWS;
  uint end = min(first + ROWS, push.size.y);
  Chroma upper = Chroma(vec4(0.0), vec4(0.0)), lower = upper;
  int have = -9;  // the chroma row in `upper`
  for (uint row = first; row < end; ++row) {
    vec4 code = codes_at(0u, row, x), r, g, b, a = vec4(1.0);
    if (MODEL == kYuv) {
      float position = float(row);
      if (H_SUB > 0u) position = 0.5 * (position - (COSITED_Y ? 0.0 : 0.5));
      int low = int(floor(position));
      if (low != have) {
        if (H_SUB > 0u && low == have + 1) upper = lower;
        else upper = chroma(low, x);
        if (H_SUB > 0u) lower = chroma(low + 1, x);
        have = low;
      }
      float part = position - float(low);
      vec4 cb = (mix(upper.cb, lower.cb, part) - push.codes.z) * push.codes.w;
      vec4 cr = (mix(upper.cr, lower.cr, part) - push.codes.z) * push.codes.w;
      vec4 y = (code - push.codes.x) * push.codes.y;
      r = light(y + push.matrix.x * cr);
      g = light(y + push.matrix.y * cb + push.matrix.z * cr);
      b = light(y + push.matrix.w * cb);
    } else {
      r = g = b = light_of_codes(code);
      if (MODEL == kRgb) {
        g = light_of_codes(codes_at(1u, row, x) / ratio_of(1u));
        b = light_of_codes(codes_at(2u, row, x) / ratio_of(2u));
      }
    }
    if (ALPHA) a = codes_at(3u, row, x) / float(largest_of(3u));
    uint at = row * push.size.x + x;
    STORE(linear, BY_ROWS(at), vec4(r.x, g.x, b.x, a.x));
    if (count > 1u) STORE(linear, BY_ROWS(at + 1u), vec4(r.y, g.y, b.y, a.y));
    if (count > 2u) STORE(linear, BY_ROWS(at + 2u), vec4(r.z, g.z, b.z, a.z));
    if (count > 3u) STORE(linear, BY_ROWS(at + 3u), vec4(r.w, g.w, b.w, a.w));
  }
}
