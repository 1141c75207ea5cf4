// SPDX-License-Identifier: LGPL-2.1-or-later
// What a frame leaves to the next one. Of a cell: (d, c0, c1, m'), d = m' - m'_P4 its local log contrast (P4: its cell of guide
// level 4). Chroma and local contrast survive a change of light, but not moving content.
vec4 cell_state(vec4 cell, vec4 wide) { return vec4(cell.x - wide.x, cell.yz, cell.x); }

// Of a pack of pixels, two vec4: m, and the brightness of its reflectance, ln of the mean channel minus s. (m is as noisy as the
// darkest channel; what is seen is the mean.)
#define MEMORY_MEAN 0
#define MEMORY_BRIGHTNESS 1
#define MEMORY_STRIDE 2

// What assemble.comp and layers.comp get to know of a pack of cells, three vec4: V - (m' + u') or what the last frame's solution
// makes of it, the gate 0...1, and which share of the last frame's reflectance stays.
#define START_VALUE 0
#define START_GATE 1
#define START_HOLD 2
#define START_STRIDE 3
