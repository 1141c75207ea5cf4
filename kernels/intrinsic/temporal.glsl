// What is kept of a frame for the next: m and s of its pixels, and a cell's (d, c0, c1, m'), d = m' - m'_P4 its local log
// contrast (P4: its cell of guide level 4). Chroma and local contrast survive a change of light, but not moving content.
vec4 cell_state(vec4 cell, vec4 wide) { return vec4(cell.x - wide.x, cell.yz, cell.x); }
