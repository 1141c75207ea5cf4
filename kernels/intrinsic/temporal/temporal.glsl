// SPDX-License-Identifier: LGPL-2.1-or-later
// History of a cell: (d, c0, c1, m'), d = m' - m'_P4 its local log contrast (P4: its cell of guide level 4). A change of light
// preserves chroma and local contrast; moving content does not.
vec4 cell_state(vec4 cell, vec4 guide_coarse) { return vec4(cell.x - guide_coarse.x, cell.yz, cell.x); }

// Decision on a cut, two vec4; the second has the mismatch to be expected in its x.
#define CUT_MISMATCH 0  // mean of the frame
#define CUT_ANCHORED 1  // 1, or 0 at a cut
#define CUT_MOVED 2     // share of the picture's structure that moved
#define CUT_FRAMES 3    // anchored since the last cut or reset
#define CUT_STRIDE 2

// A frame is a cut at this share of cut_fraction already, if its mismatch is so many times that of the frames before it, of which so
// many are needed. What is expected of them fades by the last factor a frame.
#define SUDDEN_SHARE (1.0 / 6.0)
#define SUDDEN_RATIO 8.0
#define SUDDEN_FRAMES 4.0
#define EXPECTED_FADE 0.9

// History of a pack of pixels, two vec4: m, and the brightness of its reflectance, ln of the mean channel minus s. (m is as noisy
// as the darkest channel; the mean channel is what is visible.)
#define MEMORY_MEAN 0
#define MEMORY_BRIGHTNESS 1
#define MEMORY_STRIDE 2

// Input of assemble.comp and layers.comp from a pack of cells, three vec4: V - (m' + u') or its value by the last frame's
// solution, the gate 0...1, and the share of the last frame's reflectance to keep.
#define START_VALUE 0
#define START_GATE 1
#define START_HOLD 2
#define START_STRIDE 3
