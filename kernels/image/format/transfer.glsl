// SPDX-License-Identifier: LGPL-2.1-or-later
// Transfer curves (transfer.hpp) on four values at once.
layout(constant_id = 1) const uint CURVE = 1u;
const uint kLinear = 0u, kPower = 1u, kPq = 2u, kHlg = 3u;
const float kTiny = 1e-37;  // pow is undefined below zero, and slow or undefined for denormals

// SMPTE ST 2084: its m1, m2, c1, c2, c3, and its peak of 10000 cd/m2 in units of the reference white.
const float kM1 = 0.1593017578125, kM2 = 78.84375, kC1 = 0.8359375, kC2 = 18.8515625, kC3 = 18.6875;
const float kPqPeak = 49.26108374384236;

// BT.2100 HLG: its a, b, c, and the scene light E of the reference white.
const float kHlgA = 0.17883277, kHlgB = 0.28466892, kHlgC = 0.55991073, kHlgWhite = 0.26496256;

// curve = (start, slope, scale, offset): slope x below start, else (scale x + offset)^power.
vec4 decode(vec4 x, vec4 curve, float power) {
  if (CURVE == kLinear) return x;
  if (CURVE == kPq) {
    vec4 root = pow(max(x, vec4(kTiny)), vec4(1.0 / kM2));
    return kPqPeak * pow(max(root - kC1, vec4(kTiny)) / (kC2 - kC3 * root), vec4(1.0 / kM1));
  }
  if (CURVE == kHlg)
    return mix((exp((x - kHlgC) / kHlgA) + kHlgB) / 12.0, x * x / 3.0, lessThanEqual(x, vec4(0.5))) / kHlgWhite;
  vec4 upper = pow(max(curve.z * x + curve.w, vec4(kTiny)), vec4(power));
  return mix(upper, curve.y * x, lessThan(x, vec4(curve.x)));
}

// The inverse, in the form slope x below start, else scale x^power + offset; x >= 0.
vec4 encode(vec4 x, vec4 curve, float power) {
  if (CURVE == kLinear) return x;
  if (CURVE == kPq) {
    vec4 root = pow(max(x / kPqPeak, vec4(kTiny)), vec4(kM1));
    return pow((kC1 + kC2 * root) / (1.0 + kC3 * root), vec4(kM2));
  }
  if (CURVE == kHlg) {
    vec4 scene = kHlgWhite * x;
    return mix(kHlgA * log(max(12.0 * scene - kHlgB, vec4(kTiny))) + kHlgC, sqrt(3.0 * scene),
               lessThanEqual(scene, vec4(1.0 / 12.0)));
  }
  vec4 upper = curve.z * pow(max(x, vec4(kTiny)), vec4(power)) + curve.w;
  return mix(upper, curve.y * x, lessThan(x, vec4(curve.x)));
}
