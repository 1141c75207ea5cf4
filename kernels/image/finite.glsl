// SPDX-License-Identifier: LGPL-2.1-or-later
// Input frames and layers from other elements may hold any value. Kernels make values finite when reading them, so that
// NaN and infinity do not spread between pixels or frames.
const float kLargest = 65504.0;  // the largest half float: far above any reflectance, shading or linear light

// NaN and negative values become 0, infinity kLargest. Compares bits, because positive floats order like integers and a
// compiler may not optimize this away.
vec4 finite(vec4 value) {
  ivec4 bits = floatBitsToInt(value);
  bits = mix(bits, ivec4(0), greaterThan(bits, ivec4(0x7f800000)));
  return intBitsToFloat(clamp(bits, ivec4(0), ivec4(floatBitsToInt(kLargest))));
}

const float kReflectanceFloor = 1e-3;  // lower bound of R before the logarithm
