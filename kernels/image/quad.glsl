// The quad layout of scalar planes: four horizontally adjacent pixels in one vec4, rows padded to whole quads. A plane
// of w x h pixels has wq = ceil(w / 4) quads a row; quad (x, y) lies at y * wq + x and holds pixels 4x … 4x + 3.
//
// Pixels of the padding have no edges, no mass and a zero right-hand side, so that they stay zero and influence nothing:
// every kernel that writes a plane writes its padding as zero (MASKED), and edges live with the pixel on their left or
// upper end, zero where the other end is outside.
#define QUADS(width) (((width) + 3u) / 4u)
// Which pixels of quad x exist, and which of its pixels have a neighbor on their right.
#define INSIDE(x, width) lessThan(uvec4(4u * (x)) + uvec4(0, 1, 2, 3), uvec4(width))
#define HAS_RIGHT(x, width) lessThan(uvec4(4u * (x)) + uvec4(1, 2, 3, 4), uvec4(width))
#define MASKED(value, which) mix(vec4(0.0), (value), (which))
// A quad seen one pixel further: the pixels' right neighbors, and left ones.
#define SHIFT_LEFT(quad, next) vec4((quad).yzw, (next).x)
#define SHIFT_RIGHT(quad, before) vec4((before).w, (quad).xyz)

// Where item i lies on a grid of `columns` wide rows. The float quotient may be off by one; integer division costs more than
// the two corrections.
uvec2 grid_place(uint i, uint columns) {
  uint y = uint((float(i) + 0.5) / float(columns));
  if (y * columns > i) --y;
  if (i - y * columns >= columns) ++y;
  return uvec2(i - y * columns, y);
}
// Position of this invocation on a grid that is dispatched as one line, so that no lane is spent on the ends of rows.
uvec2 grid_position(uint columns) { return grid_place(gl_GlobalInvocationID.x, columns); }

// How much every one of up to four pixels counts in a mean over a cell that has `count` of them: 2 x 2 means twice over,
// with the last row or column of an odd border counted twice.
vec4 cell_weights(uint count) {
  return count >= 4u ? vec4(0.25) : count == 3u ? vec4(0.25, 0.25, 0.5, 0.0) : count == 2u ? vec4(0.5, 0.5, 0.0, 0.0)
                                                                                : vec4(1.0, 0.0, 0.0, 0.0);
}
