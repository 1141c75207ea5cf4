// SPDX-License-Identifier: LGPL-2.1-or-later
// The energy that intrinsicdecomp minimizes (docs/reference/methods/intrinsicdecomp.md), one unknown a pixel, s = ln shading:
//
//   E(s) = sum over edges  a (ds - dm)^2 + b ds^2        even reflectance | even shading
//        + sum over cells  v (s' - V)^2                  value prior: fixes scale and low frequencies
//                        + g (m' - s' - r_bin)^2         equal chroma, equal reflectance (soft)
//        + sum over pixels t (s - s_before)^2            temporal anchor; t is constant in a cell
//
// s_before is s with the reflectance of the frame before. d is the step across an edge, m the mean log intensity; cells are
// 4 x 4 pixels, and m' and s' means over a cell.
// Reflectance is r = i - s exactly, so that the data and chromaticity terms of Eqs. 3.5 and 3.10 vanish. a, b, v, V, g are set by
// EdgePrior. E is quadratic; setting its gradient to zero,
//
//   pixels   A(x,x) = sum_N4 w + t + 1e-6    A(x,y) = -w = -(a + b)    f(x) = sum_N4 a (m_x - m_y) + t s_before
//   cells    screening = v + g               data = v V                              (added on multigrid level 2)
#include "image/pack4.glsl"

// The system of a pack: weights w of the edges to the right and down, right-hand side f and, on some levels, the mass on the
// diagonal. Levels 0 and 1 have one small constant mass and no plane for it.
#define SYSTEM_RIGHT 0
#define SYSTEM_DOWN 1
#define SYSTEM_RHS 2
#define SYSTEM_MASS 3
#define SYSTEM_FINE_STRIDE 3    // levels 0 and 1
#define SYSTEM_COARSE_STRIDE 4  // from level 2 on

// Output of EdgePrior besides the weights. Flux of a pack of pixels, two vec4: a (m_x - m_y) of its edges to the right and
// down. Value of a pack of cells, three vec4: v, V, g.
#define FLUX_RIGHT 0
#define FLUX_DOWN 1
#define FLUX_STRIDE 2
#define VALUE_WEIGHT 0
#define VALUE_TARGET 1
#define VALUE_CHROMA 2
#define VALUE_STRIDE 3

// Contribution of a pack of cells to the system: screening, data, g and m'.
#define TERMS_SCREENING 0
#define TERMS_DATA 1
#define TERMS_CHROMA 2
#define TERMS_MEAN 3
#define TERMS_STRIDE 4

// Source term of a pack of cells for its pixels, screening (target - s'), and its derivative; and the anchor's t of each of their
// pixels.
#define SOURCE_VALUE 0
#define SOURCE_SCREENING 1
#define SOURCE_ANCHOR 2
#define SOURCE_STRIDE 3
