// SPDX-License-Identifier: LGPL-2.1-or-later
// Push constants of the kernels that convert between frames and planes (convert.cpp fills them from a FrameFormat).
layout(push_constant) uniform Push {
  uvec2 size;       // pixels
  uint words;       // of the raw buffer
  uint flags;       // pack: kFlagShading, kFlagOpaque
  uvec4 offset;     // of each plane, in words
  uvec4 stride;     // of each plane, in words
  vec4 codes;       // unpack: luma offset, 1 / luma scale, chroma offset, 1 / chroma scale; pack: scales, not inverses
  vec4 matrix;      // unpack: R' from Cr, G' from Cb, G' from Cr, B' from Cb; pack: kr, kb, 1 / (2 (1 - kb)), 1 / (2 (1 - kr))
  vec4 curve;       // transfer.glsl
  float power;
  float ceiling;    // unpack: largest encoded value; pack: largest linear value
  float gain;       // pack: linear light is multiplied by it
  float largest;    // pack: largest code
  uint first_row;   // of the plane that is unpacked; of a raw buffer of one plane
} push;
const uint ROWS = 8u;         // of the strip that an invocation converts
const uint kFlagShading = 1u;  // draw the plane's w as gray
const uint kFlagOpaque = 2u;   // no alpha plane: write 1

// Samples in a word.
uvec4 bytes_of(uint word) { return (uvec4(word) >> uvec4(0u, 8u, 16u, 24u)) & 255u; }
uvec2 halves_of(uint word) { return uvec2(word & 65535u, word >> 16); }
uint word_of_bytes(uvec4 b) { return b.x | b.y << 8 | b.z << 16 | b.w << 24; }
uint word_of_halves(uvec2 h) { return h.x | h.y << 16; }

// The index of a word of a plane, clamped to the buffer: the last words of a row may reach beyond it.
int word_index(uint plane, uint row, uint index) {
  return int(min(push.offset[plane] + row * push.stride[plane] + index, push.words - 1u));
}
