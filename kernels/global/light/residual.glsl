// SPDX-License-Identifier: LGPL-2.1-or-later
// How far a residual of chroma is believed to be light and not paint: less the larger it is, but more where much of the
// light is indirect, in a scene whose indirect light is colored (`full`).
float belief(vec2 residual, float fraction, float full, float trust, float trust_tint) {
  float wide = trust_tint * full * fraction;
  return exp(-dot(residual, residual) / (2.0 * (trust * trust + wide * wide)));
}
