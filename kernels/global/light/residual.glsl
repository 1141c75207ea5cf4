// SPDX-License-Identifier: LGPL-2.1-or-later
// Confidence that a residual of chroma is light and not paint: it falls with its size, and grows with the share of indirect light,
// in a scene whose indirect light is colored (`full`).
float belief(vec2 residual, float fraction, float full, float trust, float trust_tint) {
  float wide = trust_tint * full * fraction;
  return exp(-dot(residual, residual) / (2.0 * (trust * trust + wide * wide)));
}
