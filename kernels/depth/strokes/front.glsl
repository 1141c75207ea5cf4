// SPDX-License-Identifier: LGPL-2.1-or-later
// Adds a voxel to the front of a pass. Needs WORD_INOUT `front` and `state`. What does not fit is marked, and spreads from the next
// marking on.
void add_to_front(uint pass, uint voxel) {
  uint n = atomicAdd(LOAD(state, pass * STATE_STRIDE + STATE_FRONT), 1u);
  if (n >= FRONT_MAX) return;
  STORE(front, (pass & 1u) * FRONT_MAX + n, voxel);
  if (n % FRONT_GROUP == 0u) atomicMax(LOAD(state, pass * STATE_STRIDE), n / FRONT_GROUP + 1u);
}
