// The energy that intrinsicdecomp minimizes, one frame: a log shading s a pixel, all else follows.
//
//   log image      i = ln(I + intensity_floor), m = mean_c i, u = max_c i - m
//   log chroma     c0 = ln R/G, c1 = ln sqrt(RG)/B, of I + chroma_floor
//   reflectance    r = i - s (exactly), so that the data and chromaticity terms of Eqs. 3.5 and 3.10 vanish
//
//   E(s) =   sum over edges x-y   a rho(3 (dm - ds)^2 + Q) + b ds^2       dm = m_x - m_y, ds = s_x - s_y
//          + sum over pixels      v (s - V)^2                             gauge prior (EdgePrior)
//          + sum over pixels      g (s - (m - r_bin))^2                   non-local term through chroma bins
//          + sum over pixels      w_t e^(-(k dc)^2) (s - (m - r_prev))^2  temporal anchor
//
//   rho(z) = (z + e^2)^(p/2) is the sparse penalty of Eq. 3.8 on the reflectance step; Q = dc0^2 / 2 + 2 dc1^2 / 3 is the
//   chroma part of that step, which s cannot change. Iteratively reweighted least squares (3.5.1) replaces rho by
//   (p/2) (z0 + e^2)^(p/2 - 1) z, consistent with the energy (the factor p/2 is missing in Eq. 3.19):
//
//   A(x,x) = sum_N4 w + mass   A(x,y) = -w = -(a' + b)   rhs = sum_N4 a' (m_x - m_y) + v V + g (m - r_bin) + ...

// Edges of a quad, as EdgePrior writes them, three vec4 a direction: a, Q, b.
#define EDGE_SPARSE 0
#define EDGE_CHROMA 1
#define EDGE_SMOOTH 2
#define EDGE_STRIDE 3

// The linear system of a quad, four vec4: weights w of the edges to the right and down, the diagonal's own mass, rhs.
#define SYSTEM_RIGHT 0
#define SYSTEM_DOWN 1
#define SYSTEM_MASS 2
#define SYSTEM_RHS 3
#define SYSTEM_STRIDE 4
