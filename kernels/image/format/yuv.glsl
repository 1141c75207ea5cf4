// SPDX-License-Identifier: LGPL-2.1-or-later
// Layouts of Y'CbCr frames, chroma interpolation and averaging, and matrices.
layout(constant_id = 2) const uint LAYOUT = 0u;
const uint kSemiPlanar = 0u, kPlanar = 1u, kYuy2 = 2u, kUyvy = 3u;
layout(constant_id = 3) const bool DEEP = false;  // 16-bit words
layout(constant_id = 4) const uint SHIFT = 0u;    // of the code in its word
layout(constant_id = 5) const bool COSITED_X = true;
layout(constant_id = 6) const bool COSITED_Y = false;
const bool PACKED = LAYOUT >= kYuy2;  // 4:2:2

// Chroma of four pixels from four samples: the one to the left, the two of these pixels, the one to the right.
vec4 upsample(vec4 chroma) {
  if (COSITED_X) return vec4(chroma.y, 0.5 * (chroma.y + chroma.z), chroma.z, 0.5 * (chroma.z + chroma.w));
  return 0.75 * chroma.yyzz + 0.25 * chroma.xzyw;
}

// Two chroma samples from the pixel to the left and the four pixels.
vec2 downsample(float left, vec4 chroma) {
  if (COSITED_X) return 0.5 * chroma.xz + 0.25 * (vec2(left, chroma.y) + chroma.yw);
  return 0.5 * (chroma.xz + chroma.yw);
}
