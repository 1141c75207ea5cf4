// Layers may carry anything that a frame or somebody else's element put into them: kernels make every value finite where
// they read it, so that nothing spreads from pixel to pixel or into later frames.
const float kLargest = 65504.0;  // the largest half float: far above any reflectance, shading or linear light

// Not-a-numbers and negatives become 0, infinity kLargest. By bits: positive floats order like integers, and no compiler
// may assume its way around it.
vec4 finite(vec4 value) {
  ivec4 bits = floatBitsToInt(value);
  bits = mix(bits, ivec4(0), greaterThan(bits, ivec4(0x7f800000)));
  return intBitsToFloat(clamp(bits, ivec4(0), ivec4(floatBitsToInt(kLargest))));
}

const float kReflectanceFloor = 1e-3;  // what ln R is taken of at least
