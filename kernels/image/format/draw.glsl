// SPDX-License-Identifier: LGPL-2.1-or-later
// Pixels of a plane as encoded R', G', B' ready for output: four in a row, component by component.
PLANE_IN(0, picture);
// From the plane's primaries to the frame's, row by row; false: they are the same.
layout(constant_id = 50) const bool GAMUT = false;
layout(constant_id = 51) const float RED_RED = 1.0;
layout(constant_id = 52) const float RED_GREEN = 0.0;
layout(constant_id = 53) const float RED_BLUE = 0.0;
layout(constant_id = 54) const float GREEN_RED = 0.0;
layout(constant_id = 55) const float GREEN_GREEN = 1.0;
layout(constant_id = 56) const float GREEN_BLUE = 0.0;
layout(constant_id = 57) const float BLUE_RED = 0.0;
layout(constant_id = 58) const float BLUE_GREEN = 0.0;
layout(constant_id = 59) const float BLUE_BLUE = 1.0;

// NaN and negative values become 0, infinity the maximum. Compares bits, because positive floats order like integers
// and a compiler may not optimize this away.
vec4 sanitized(vec4 value, float top) {
  ivec4 bits = floatBitsToInt(value);
  bits = mix(bits, ivec4(0), greaterThan(bits, ivec4(0x7f800000)));
  return intBitsToFloat(clamp(bits, ivec4(0), ivec4(floatBitsToInt(top))));
}

const float kLargest = 65504.0;  // as in finite.glsl

struct Pack { vec4 r, g, b; };
Pack encoded(vec4 r, vec4 g, vec4 b) {
  if (GAMUT) {
    vec4 red = sanitized(r, kLargest), green = sanitized(g, kLargest), blue = sanitized(b, kLargest);
    r = RED_RED * red + RED_GREEN * green + RED_BLUE * blue;
    g = GREEN_RED * red + GREEN_GREEN * green + GREEN_BLUE * blue;
    b = BLUE_RED * red + BLUE_GREEN * green + BLUE_BLUE * blue;
  }
  return Pack(encode(sanitized(r * push.gain, push.ceiling), push.curve, push.power),
              encode(sanitized(g * push.gain, push.ceiling), push.curve, push.power),
              encode(sanitized(b * push.gain, push.ceiling), push.curve, push.power));
}

vec4 color_at(uint row, uint column) {
  vec4 pixel = FETCH(picture, int(row * push.size.x + min(column, push.size.x - 1u)));
  return (push.flags & kFlagShading) != 0u ? pixel.wwww : pixel;
}

Pack pack_at(uint row, uint column) {
  vec4 p = color_at(row, column), q = color_at(row, column + 1u), s = color_at(row, column + 2u),
       t = color_at(row, column + 3u);
  return encoded(vec4(p.x, q.x, s.x, t.x), vec4(p.y, q.y, s.y, t.y), vec4(p.z, q.z, s.z, t.z));
}

// The code of a value in 0...1 (chroma: -1/2...1/2), rounded to nearest.
uvec4 code_of(vec4 value, float offset, float scale) {
  return uvec4(clamp(value * scale + offset, 0.0, push.largest) + 0.5);
}
