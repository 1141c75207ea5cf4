// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "gpu/common.glsl"
#include "frame.glsl"
#include "transfer.glsl"
#include "samples.glsl"
#include "draw.glsl"

// A plane to frames of any described format. Each invocation writes a strip of ACROSS x ROWS pixels, ACROSS such that
// its part of each row is whole words. Pixels beyond the right edge repeat the last one.
layout(constant_id = 13) const uint ACROSS = 4u;
PLANE_IN(1, alpha_plane);
WORD_OUT(2, raw);

const uint kMaxAcross = 16u, kMaxWords = 8u;
uint span() { return 1u << W_SUB; }  // pixels of a chroma sample
bool is_subsampled() { return MODEL == kYuv && (W_SUB > 0u || H_SUB > 0u); }

uint samples_of(uint c, uint pixels) { return is_chroma(c) ? (pixels + span() - 1u) >> W_SUB : pixels; }
// Words of a row of so many pixels.
uint words_of(uint plane, uint pixels) {
  uint units = 0u;
  [[unroll]] for (uint c = 0u; c < 4u; ++c)
    if (exists(c) && plane_of(c) == plane) units = max(units, samples_of(c, pixels) * stride_of(c));
  return UNIT == kThirds ? (units + 2u) / 3u : (units + 3u) / 4u;
}

uint words[4u * 2u * kMaxWords];  // of this strip: four planes, up to two rows
void put(uint c, uint line, uint sample_index, uint code) {
  uint at = sample_index * stride_of(c) + offset_of(c);
  code <<= shift_of(c);
  if (UNIT == kBe16) code = swap16(code);
  if (UNIT == kBe32) code = swap32(code);
  words[(plane_of(c) * 2u + line) * kMaxWords + word_of(at)] |= code << bit_of(at);
}
void put4(uint c, uint line, uint x, vec4 value, float offset, float scale) {
  uvec4 code = uvec4(clamp(value * scale + offset, 0.0, push.largest) * ratio_of(c) + 0.5);
  [[unroll]] for (uint i = 0u; i < 4u; ++i) put(c, line, x + i, code[i]);
}

// Cb and Cr of one row: up to three pixels left of the strip, then the strip.
const uint kMargin = 3u;
float row_cb[kMargin + kMaxAcross], row_cr[kMargin + kMaxAcross];
// Cb and Cr of the chroma samples, summed over rows.
float sum_cb[kMaxAcross], sum_cr[kMaxAcross];

vec4 luma(Pack p) {
  return push.matrix.x * p.r + (1.0 - push.matrix.x - push.matrix.y) * p.g + push.matrix.y * p.b;
}

vec4 alpha_at(uint row, uint x) {
  if ((push.flags & kFlagOpaque) != 0u || !ALPHA) return vec4(1.0);
  uint start = row * push.size.x, last = push.size.x - 1u;
  return sanitized(vec4(FETCH(alpha_plane, int(start + min(x, last))).w, FETCH(alpha_plane, int(start + min(x + 1u, last))).w,
                        FETCH(alpha_plane, int(start + min(x + 2u, last))).w,
                        FETCH(alpha_plane, int(start + min(x + 3u, last))).w), 1.0);
}

// Draws a row of the strip into `words` if it is its `own`, and adds its chroma to the sums.
void draw(uint row, uint first, uint line, bool own, float weight) {
  [[unroll]] for (uint x = 0u; x < ACROSS; x += 4u) {
    Pack p = pack_at(row, first + x);
    vec4 y = luma(p), cb = (p.b - y) * push.matrix.z, cr = (p.r - y) * push.matrix.w;
    if (own) {
      put4(0u, line, x, MODEL == kRgb ? p.r : y, push.codes.x, push.codes.y);
      if (MODEL == kRgb) {
        put4(1u, line, x, p.g, push.codes.x, push.codes.y);
        put4(2u, line, x, p.b, push.codes.x, push.codes.y);
      }
      if (MODEL == kYuv && !is_subsampled()) {
        put4(1u, line, x, cb, push.codes.z, push.codes.w);
        put4(2u, line, x, cr, push.codes.z, push.codes.w);
      }
      if (exists(3u)) put4(3u, line, x, alpha_at(row, first + x), 0.0, push.largest);
    }
    if (is_subsampled()) {
      [[unroll]] for (uint i = 0u; i < 4u; ++i) {
        row_cb[kMargin + x + i] = cb[i];
        row_cr[kMargin + x + i] = cr[i];
      }
    }
  }
  if (!is_subsampled()) return;
  if (COSITED_X) {
    [[unroll]] for (uint i = 1u; i < span(); ++i) {
      vec4 left = color_at(row, max(first, i) - i);
      Pack p = encoded(left.xxxx, left.yyyy, left.zzzz);
      float y = luma(p).x;
      row_cb[kMargin - i] = (p.b.x - y) * push.matrix.z;
      row_cr[kMargin - i] = (p.r.x - y) * push.matrix.w;
    }
  }
  [[unroll]] for (uint s = 0u; s < ACROSS >> W_SUB; ++s) {
    uint at = kMargin + (s << W_SUB);
    float cb = 0.0, cr = 0.0;
    [[unroll]] for (uint i = 0u; i < span(); ++i) {
      if (COSITED_X) {  // a triangle as wide as the distance to the next samples
        float part = float(span() - i) / float(span() * span());
        cb += part * row_cb[at + i];
        cr += part * row_cr[at + i];
        if (i > 0u) {
          cb += part * row_cb[at - i];
          cr += part * row_cr[at - i];
        }
      } else {
        cb += row_cb[at + i] / float(span());
        cr += row_cr[at + i] / float(span());
      }
    }
    sum_cb[s] += weight * cb;
    sum_cr[s] += weight * cr;
  }
}

uint chroma_code(float value) { return uint(clamp(value * push.codes.w + push.codes.z, 0.0, push.largest) + 0.5); }

void store(uint row, uint block, uint lines) {
  [[unroll]] for (uint plane = 0u; plane < 4u; ++plane) {
    uint within = words_of(plane, ACROSS), in_row = words_of(plane, push.size.x);
    bool halved = H_SUB > 0u && plane_of(0u) != plane && !(exists(3u) && plane_of(3u) == plane);
    [[unroll]] for (uint line = 0u; line < 2u; ++line)
      if (line < (halved ? 1u : lines))
        [[unroll]] for (uint i = 0u; i < within; ++i)
          if (block * within + i < in_row)
            STORE(raw, push.offset[plane] + ((halved ? row >> 1 : row) + line - push.first_row) * push.stride[plane] + block * within + i,
                  words[(plane * 2u + line) * kMaxWords + i]);
  }
}

void main() {
  uvec2 place = gl_GlobalInvocationID.xy;
  uint block = place.x, first = block * ACROSS;
  if (first >= push.size.x) return;
  uint begin = push.first_row + place.y * ROWS, end = min(begin + ROWS, push.size.y);
  for (uint row = begin; row < end; row += 1u << H_SUB) {
    [[unroll]] for (uint i = 0u; i < words.length(); ++i) words[i] = 0u;
    [[unroll]] for (uint i = 0u; i < kMaxAcross; ++i) sum_cb[i] = sum_cr[i] = 0.0;
    uint lines = min(1u << H_SUB, end - row);
    draw(row, first, 0u, true, H_SUB > 0u ? 0.5 : 1.0);
    if (H_SUB > 0u) {
      draw(row + lines - 1u, first, 1u, lines > 1u, COSITED_Y ? 0.25 : 0.5);
      if (COSITED_Y) draw(max(row, 1u) - 1u, first, 0u, false, 0.25);
    }
    if (is_subsampled()) {
      [[unroll]] for (uint s = 0u; s < ACROSS >> W_SUB; ++s) {
        put(1u, 0u, s, chroma_code(sum_cb[s]));
        put(2u, 0u, s, chroma_code(sum_cr[s]));
      }
    }
    store(row, block, lines);
  }
}
