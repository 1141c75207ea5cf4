// SPDX-License-Identifier: LGPL-2.1-or-later
// Confidence that a residual of chroma (log units) is light and not paint: a Gaussian of its size. The variance grows with the
// share of indirect light, `fraction`, if the scene's indirect light is colored, `full` = 1.
float light_confidence(vec2 residual, float fraction, float full, float residual_sigma, float tint_sigma) {
  float tint = tint_sigma * full * fraction;
  return exp(-dot(residual, residual) / (2.0 * (residual_sigma * residual_sigma + tint * tint)));
}
