// SPDX-License-Identifier: LGPL-2.1-or-later
// Transfer curves (transfer.hpp) on four values at once. CURVE is false for linear formats, which skip them.
layout(constant_id = 1) const bool CURVE = true;
const float kTiny = 1e-37;  // pow is undefined below zero, and slow or undefined for denormals

// curve = (start, slope, scale, offset): slope x below start, else (scale x + offset)^power.
vec4 decode(vec4 x, vec4 curve, float power) {
  if (!CURVE) return x;
  vec4 upper = pow(max(curve.z * x + curve.w, vec4(kTiny)), vec4(power));
  return mix(upper, curve.y * x, lessThan(x, vec4(curve.x)));
}

// The inverse, in the form slope x below start, else scale x^power + offset; x >= 0.
vec4 encode(vec4 x, vec4 curve, float power) {
  if (!CURVE) return x;
  vec4 upper = curve.z * pow(max(x, vec4(kTiny)), vec4(power)) + curve.w;
  return mix(upper, curve.y * x, lessThan(x, vec4(curve.x)));
}
