// SPDX-License-Identifier: LGPL-2.1-or-later
// The per-light layers of the relighting network (training/olat/README.md), for four lights at a time, so that weights
// are read once for all of them.
//
//     u_k = max(0, F_4k w.x + F_4k+1 w.y + F_4k+2 w.z + F_4k+3)          16 of them: a block of features is a plane
//     v_j = max(0, Σ_k W_jk u_k + bias_j(w))                             24; what depends on the light alone is in the bias
//     y   = Σ_j V_j v_j + c
//     P   = max(0, x y.rgb + mean(x) y.a)²,  x = √(A + B)
// Bindings: head_weights, per block of four j the 16 columns of W, then the four of V; finally c. lights, kLightSize
// vec4 each: direction and 1; weight; six of bias.

const int kBlocks = 16, kHiddenBlocks = 6;  // of features; of v
const int kLightSize = 8;                   // vec4 a light
const int kAtOnce = 4;                      // lights

#define HEAD_PLANES(U, first)                                                                                   \
  {                                                                                                             \
    vec4 w = FETCH(lights, first);                                                                              \
    U##0 = max(vec4(dot(f[0], w), dot(f[1], w), dot(f[2], w), dot(f[3], w)), 0.0);                              \
    U##1 = max(vec4(dot(f[4], w), dot(f[5], w), dot(f[6], w), dot(f[7], w)), 0.0);                              \
    U##2 = max(vec4(dot(f[8], w), dot(f[9], w), dot(f[10], w), dot(f[11], w)), 0.0);                            \
    U##3 = max(vec4(dot(f[12], w), dot(f[13], w), dot(f[14], w), dot(f[15], w)), 0.0);                          \
  }
#define HEAD_COLUMN(k, block, part)                 \
  {                                                 \
    vec4 w = FETCH(head_weights, at + k);           \
    va += w * ua##block.part;                       \
    vb += w * ub##block.part;                       \
    vc += w * uc##block.part;                       \
    vd += w * ud##block.part;                       \
  }
#define HEAD_OUT(k, part)                           \
  {                                                 \
    vec4 w = FETCH(head_weights, at + 16 + k);      \
    ya += w * va.part;                              \
    yb += w * vb.part;                              \
    yc += w * vc.part;                              \
    yd += w * vd.part;                              \
  }

// P of four lights from `first` on, for a pixel of features f and F = A + B.
void light_head(vec4 f[16], vec3 full, int first, out vec3 pa, out vec3 pb, out vec3 pc, out vec3 pd) {
  vec4 ua0, ua1, ua2, ua3, ub0, ub1, ub2, ub3, uc0, uc1, uc2, uc3, ud0, ud1, ud2, ud3;
  int l = first * kLightSize;
  HEAD_PLANES(ua, l)
  HEAD_PLANES(ub, l + kLightSize)
  HEAD_PLANES(uc, l + 2 * kLightSize)
  HEAD_PLANES(ud, l + 3 * kLightSize)
  vec4 ya = FETCH(head_weights, kHiddenBlocks * 20), yb = ya, yc = ya, yd = ya;
  for (int j = 0; j < kHiddenBlocks; ++j) {
    int at = 20 * j;
    vec4 va = FETCH(lights, l + 2 + j), vb = FETCH(lights, l + kLightSize + 2 + j),
         vc = FETCH(lights, l + 2 * kLightSize + 2 + j), vd = FETCH(lights, l + 3 * kLightSize + 2 + j);
    HEAD_COLUMN(0, 0, x) HEAD_COLUMN(1, 0, y) HEAD_COLUMN(2, 0, z) HEAD_COLUMN(3, 0, w)
    HEAD_COLUMN(4, 1, x) HEAD_COLUMN(5, 1, y) HEAD_COLUMN(6, 1, z) HEAD_COLUMN(7, 1, w)
    HEAD_COLUMN(8, 2, x) HEAD_COLUMN(9, 2, y) HEAD_COLUMN(10, 2, z) HEAD_COLUMN(11, 2, w)
    HEAD_COLUMN(12, 3, x) HEAD_COLUMN(13, 3, y) HEAD_COLUMN(14, 3, z) HEAD_COLUMN(15, 3, w)
    va = max(va, 0.0);
    vb = max(vb, 0.0);
    vc = max(vc, 0.0);
    vd = max(vd, 0.0);
    HEAD_OUT(0, x) HEAD_OUT(1, y) HEAD_OUT(2, z) HEAD_OUT(3, w)
  }
  vec3 x = sqrt(full);
  float mean = (x.r + x.g + x.b) / 3.0;
  pa = max(x * ya.rgb + mean * ya.a, 0.0);
  pb = max(x * yb.rgb + mean * yb.a, 0.0);
  pc = max(x * yc.rgb + mean * yc.a, 0.0);
  pd = max(x * yd.rgb + mean * yd.a, 0.0);
  pa *= pa;
  pb *= pb;
  pc *= pc;
  pd *= pd;
}
