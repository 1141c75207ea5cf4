// What is kept of a frame for the next: a cell's (d, c0, c1, r), d = m' - m'_P4 its local log contrast (P4: its cell of
// guide level 4), r = m' - s'. Chroma and local contrast survive a change of light, but not moving content.
vec4 cell_state(vec4 cell, vec4 wide) { return vec4(cell.x - wide.x, cell.yz, 0.0); }
// q: squared differences in units of those that halve the anchor.
float mismatch(vec4 state, vec4 before, float detail, float chroma) {
  float d = detail * (state.x - before.x);
  vec2 c = chroma * (state.yz - before.yz);
  return d * d + dot(c, c);
}
