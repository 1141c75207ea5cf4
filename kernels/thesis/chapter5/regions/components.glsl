// SPDX-License-Identifier: LGPL-2.1-or-later
// The words that lead to the roots. Coherent: other invocations change them on the way.
layout(set = 0, binding = ROOTS_SLOT, std430) coherent buffer roots_block { uint roots_data[]; };

uint root_of(uint n) {
  uint next = roots_data[n];
  while (next != n) {
    n = next;
    next = roots_data[n];
  }
  return n;
}
