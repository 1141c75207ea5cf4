// SPDX-License-Identifier: LGPL-2.1-or-later
// Inputs and outputs of the fitted functions of EdgePrior (docs/reference/methods/intrinsicdecomp.md, 2).
const float kLogLow = -4.5, kLogHigh = 3.0;

// log2(x + 0.01) for x >= 0, to 1e-4, for cues (ln(x + 0.01) + center) / 1.5: scale and center are in the constants of the
// functions. They need no more, and there are seven logarithms an edge. That of the mantissa is a polynomial (Chebyshev
// interpolation of degree 4).
float cue(float x) {
  int bits = floatBitsToInt(x + 0.01);
  float m = intBitsToFloat((bits & 0x7fffff) | 0x3f800000);
  return float(bits >> 23) + ((((-0.0784406763 * m + 0.626032182) * m - 2.07833517) * m + 4.0292114) * m - 129.498353);
}

// e^log_weight within the limits, to 1e-5: 2 to the power of the fractional part by a polynomial (minimax, degree 4).
float weight(float log_weight) {
  float power = clamp(log_weight, kLogLow, kLogHigh) * 1.442695041 + 127.0;  // positive, so that int() rounds down
  int whole = int(power);
  float x = power - float(whole);
  return intBitsToFloat(whole << 23) *
         ((((0.0135341672 * x + 0.0520114619) * x + 0.241442756) * x + 0.693003835) * x + 1.00000259);
}
