// SPDX-License-Identifier: LGPL-2.1-or-later
// The guide as a network of the prior sees it: its mean over the 2^level x 2^level pixels of a network pixel. Needs the planes level0,
// level1 and cells, and push.size and push.level.

// The place on level 2 of part k of the network pixel at `at`: of the ones on the way down, the last counts twice at an odd border.
int place(int at, int k, int size2) {
  for (int shift = push.level - 3; shift >= 0; --shift)
    at = min(2 * at + ((k >> shift) & 1), ((size2 - 1) >> shift));
  return at;
}

// The guide at a network pixel.
vec4 mean_guide(ivec2 at) {
  if (push.level == 0) return FETCH(level0, at.y * push.size.x + at.x);
  ivec2 size1 = (push.size + 1) / 2, size2 = (size1 + 1) / 2;
  if (push.level == 1) return FETCH(level1, at.y * size1.x + at.x);
  vec4 sum = vec4(0.0);
  int count = 1 << (push.level - 2);
  for (int j = 0; j < count; ++j) {
    int row = place(at.y, j, size2.y) * size2.x;
    for (int i = 0; i < count; ++i) sum += FETCH(cells, CELL_STRIDE * (row + place(at.x, i, size2.x)));
  }
  return sum / float(count * count);
}
