// SPDX-License-Identifier: LGPL-2.1-or-later
// Layout of scalar planes: four horizontally adjacent pixels in one vec4, rows padded to multiples of four. A plane of
// w x h pixels has wq = ceil(w / 4) vec4 per row; vec4 (x, y) is at y * wq + x and holds pixels 4x … 4x + 3.
//
// Padding pixels have no edges, no mass and a zero right-hand side, so they stay zero and have no influence. Every
// kernel writes padding as zero (MASKED). An edge is stored at its left or upper pixel, and is zero if the other one is
// outside.
#define PACK4(width) (((width) + 3u) / 4u)
// Mask of the existing pixels.
#define INSIDE(x, width) lessThan(uvec4(4u * (x)) + uvec4(0, 1, 2, 3), uvec4(width))
#define MASKED(value, which) mix(vec4(0.0), (value), (which))
// Right and left neighbors of four pixels.
#define SHIFT_LEFT(pack, next) vec4((pack).yzw, (next).x)
#define SHIFT_RIGHT(pack, before) vec4((before).w, (pack).xyz)

// Position of item i on a grid of `columns` per row. The float quotient may be off by one; correcting it is cheaper
// than integer division.
uvec2 grid_place(uint i, uint columns) {
  uint y = uint((float(i) + 0.5) / float(columns));
  if (y * columns > i) --y;
  if (i - y * columns >= columns) ++y;
  return uvec2(i - y * columns, y);
}
// Position of this invocation on a grid dispatched as one line, so that no lanes are idle at the ends of rows.
uvec2 grid_position(uint columns) { return grid_place(line_index(), columns); }

// Weight of each of up to four pixels in the mean of a cell with `count` of them. The last row or column of an odd
// border counts twice.
vec4 cell_weights(uint count) {
  return count >= 4u ? vec4(0.25) : count == 3u ? vec4(0.25, 0.25, 0.5, 0.0) : count == 2u ? vec4(0.5, 0.5, 0.0, 0.0)
                                                                                : vec4(1.0, 0.0, 0.0, 0.0);
}
