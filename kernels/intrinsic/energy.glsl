// The energy that intrinsicdecomp minimizes (docs/method-intrinsicdecomp.md), one unknown a pixel, s = ln shading:
//
//   E(s) = sum over edges   a (ds - dm)^2 + b ds^2       paint is even here | light is even here
//        + sum over pixels  v (s - V)^2                  value prior: pins scale and low frequencies
//                         + g (m - s - r_bin)^2          equal chroma, equal reflectance (soft)
//                         + t (m - s - r_previous)^2     temporal anchor
//
// d is the step across an edge, m the mean log intensity; reflectance is r = i - s exactly, so that the data and
// chromaticity terms of Eqs. 3.5 and 3.10 vanish. a, b, v, V, g come from EdgePrior. E is quadratic: its minimum solves
//
//   A(x,x) = sum_N4 w + mass      A(x,y) = -w = -(a + b)      mass = v + g + t
//   f(x)   = base + g (m - r_bin)      base = v V + t (m - r_previous) + sum_N4 a (m_x - m_y)
#include "quad.glsl"

// The system of a quad, four vec4: weights w of the edges to the right and down, mass, right-hand side f.
#define SYSTEM_RIGHT 0
#define SYSTEM_DOWN 1
#define SYSTEM_MASS 2
#define SYSTEM_RHS 3
#define SYSTEM_STRIDE 4

// What EdgePrior writes beside the weights. Flux of a quad, two vec4: a (m_x - m_y) of its edges to the right and down;
// value of a quad, three vec4: v, V, g.
#define FLUX_RIGHT 0
#define FLUX_DOWN 1
#define FLUX_STRIDE 2
#define VALUE_WEIGHT 0
#define VALUE_TARGET 1
#define VALUE_CHROMA 2
#define VALUE_STRIDE 3
