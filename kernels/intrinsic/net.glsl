// What the fitted functions of EdgePrior are evaluated on and what their outputs mean
// (docs/method-intrinsicdecomp.md, 2).
const float kLogLow = -4.5, kLogHigh = 3.0;

// (ln(x + 0.01) + center) / 1.5 for x >= 0, to 6e-5: cues need no more, and there are seven logarithms an edge. ln of the
// mantissa by a polynomial (Chebyshev interpolation of degree 4).
float cue(float x, float center) {
  const float kScale = 1.0 / 1.5, kLn2 = 0.6931471806;
  int bits = floatBitsToInt(x + 0.01);
  float exponent = float((bits >> 23) - 127), m = intBitsToFloat((bits & 0x7fffff) | 0x3f800000);
  float mantissa = (((-0.0543709336 * m + 0.433932442) * m - 1.44059216) * m + 2.79283652) * m - 1.73172644;
  return exponent * (kLn2 * kScale) + mantissa * kScale + center * kScale;
}

float weight(float log_weight) { return exp(clamp(log_weight, kLogLow, kLogHigh)); }
