// SPDX-License-Identifier: LGPL-2.1-or-later
// The energy that intrinsicdecomp minimizes (docs/reference/methods/intrinsicdecomp.md), one unknown a pixel, s = ln shading:
//
//   E(s) = sum over edges  a (ds - dm)^2 + b ds^2        even reflectance | even shading
//        + sum over cells  g (m' - s' - r_bin)^2         equal chroma, equal reflectance (soft)
//        + sum over pixels t (s - s_before)^2            temporal anchor; t is constant in a cell
//
// s_before is s with the reflectance of the frame before. d is the step across an edge, m the mean log intensity; cells are
// 4 x 4 pixels, and m' and s' means over a cell.
// Reflectance is r = i - s exactly, so that the data and chromaticity terms of Eqs. 3.5 and 3.10 vanish. a, b, g are set by
// EdgePrior. E is quadratic. The scale of s is fixed by a small mass
// of every pixel, mass (s - first solution)^2. Setting the gradient to zero,
//
//   pixels   A(x,x) = sum_N4 w + t + mass    A(x,y) = -w = -(a + b)    f(x) = sum_N4 a (m_x - m_y) + t s_before
//   cells    screening = g                   (added on multigrid level 2)
#include "image/pack4.glsl"

// The system of a pack: weights w of the edges to the right and down, right-hand side f and, on some levels, the mass on the
// diagonal. Levels 0 and 1 have one small constant mass and no plane for it.
#define SYSTEM_RIGHT 0
#define SYSTEM_DOWN 1
#define SYSTEM_RHS 2
#define SYSTEM_MASS 3
#define SYSTEM_FINE_STRIDE 3    // levels 0 and 1
#define SYSTEM_COARSE_STRIDE 4  // from level 2 on

// The first solution, of (m, .., .., u) and the frame's mean of m: half of what max_c i differs from the mean is light. It is nearer to
// the minimum than all (R = 1) or nothing (S = 1).
#define first_solution(guide, mean) (0.5 * ((guide).x + (guide).w + (mean)))

// Output of EdgePrior besides the weights. Flux of a pack of pixels, two vec4: a (m_x - m_y) of its edges to the right and
// down.
#define FLUX_RIGHT 0
#define FLUX_DOWN 1
#define FLUX_STRIDE 2

// Terms of a pack of cells: g and m'.
#define TERMS_CHROMA 0
#define TERMS_MEAN 1
#define TERMS_STRIDE 2

// Source term of a pack of cells for its pixels, g (target - s'), and its derivative; and of each of their pixels
// the anchor's t and the mass.
#define SOURCE_VALUE 0
#define SOURCE_SCREENING 1
#define SOURCE_ANCHOR 2
#define SOURCE_STRIDE 3
