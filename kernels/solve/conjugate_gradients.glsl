// SPDX-License-Identifier: LGPL-2.1-or-later
// Shared parts of conjugate gradients with a diagonal preconditioner.

/// Jacobi preconditioner M⁻¹, zero if the diagonal is.
vec4 precondition(vec4 diagonal, vec4 v) {
  return mix(vec4(0.0), v / max(diagonal, 1e-30), greaterThan(diagonal, vec4(1e-30)));
}

// Whether a direction d of the conjugate gradients has a curvature above rounding: of (dᵀA d, dᵀM d), M the diagonal. For an
// unknown without any term (a pixel's gray value without data term, samples and a neighbor of its color) A is singular, and a step
// along the remainder of dᵀA d would be arbitrary.
bool curves(vec2 products) { return products.x > 1e-8 * products.y; }
