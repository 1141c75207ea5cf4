// SPDX-License-Identifier: LGPL-2.1-or-later
// Samples of any format that a PixelFormat describes. The description is in specialization constants, so that what
// follows from it is folded when the kernel is compiled.
layout(constant_id = 2) const uint MODEL = 1u;
const uint kGray = 0u, kRgb = 1u, kYuv = 2u;
layout(constant_id = 3) const uint UNIT = 0u;
const uint kByte = 0u, kLe16 = 1u, kBe16 = 2u, kLe32 = 3u, kBe32 = 4u, kThirds = 5u;
layout(constant_id = 4) const uint W_SUB = 0u;  // log2 of the subsampling of chroma
layout(constant_id = 5) const uint H_SUB = 0u;
layout(constant_id = 6) const bool COSITED_X = true;
layout(constant_id = 7) const bool COSITED_Y = false;
layout(constant_id = 8) const bool ALPHA = true;
// Plane, offset, stride, shift and depth of each component, from bits 0, 2, 6, 10 and 15 on.
layout(constant_id = 9) const uint COMPONENT0 = 0u;
layout(constant_id = 10) const uint COMPONENT1 = 0u;
layout(constant_id = 11) const uint COMPONENT2 = 0u;
layout(constant_id = 12) const uint COMPONENT3 = 0u;

uint component(uint c) { return c == 0u ? COMPONENT0 : c == 1u ? COMPONENT1 : c == 2u ? COMPONENT2 : COMPONENT3; }
uint plane_of(uint c) { return component(c) & 3u; }
uint offset_of(uint c) { return component(c) >> 2 & 15u; }
uint stride_of(uint c) { return component(c) >> 6 & 15u; }
uint shift_of(uint c) { return component(c) >> 10 & 31u; }
uint depth_of(uint c) { return component(c) >> 15; }
uint largest_of(uint c) { return (1u << depth_of(c)) - 1u; }
bool exists(uint c) { return depth_of(c) > 0u; }
bool is_chroma(uint c) { return MODEL == kYuv && (c == 1u || c == 2u); }
// Codes of a component per code of the first: 1 unless green has a bit more.
float ratio_of(uint c) { return float(largest_of(c)) / float(largest_of(0u)); }

uint swap16(uint half_word) { return half_word >> 8 | (half_word & 255u) << 8; }
uint swap32(uint word) { return swap16(word >> 16) | swap16(word & 65535u) << 16; }

// Index of the word of a row that unit `at` lies in, and its first bit there.
uint word_of(uint at) { return UNIT == kThirds ? at / 3u : at / 4u; }
uint bit_of(uint at) { return UNIT == kThirds ? at % 3u * 10u : UNIT >= kLe32 ? 0u : at % 4u * 8u; }
