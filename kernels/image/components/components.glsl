// SPDX-License-Identifier: LGPL-2.1-or-later
// Connected components of pixels with equal labels, 4-connected, by union-find (Playne and Hawick, A New Algorithm for Parallel
// Connected-Component Labelling on GPUs, IEEE TPDS 29(6), 2018): every pixel's word leads to a pixel of lower index in its
// component, the root to itself. A kernel that includes this defines ROOTS_SLOT, the binding of these words. Coherent: other
// invocations change them on the way.
layout(set = 0, binding = ROOTS_SLOT, std430) coherent buffer roots_block { uint roots_data[]; };

uint root_of(uint n) {
  uint next = roots_data[n];
  while (next != n) {
    n = next;
    next = roots_data[n];
  }
  return n;
}
