// SPDX-License-Identifier: LGPL-2.1-or-later
// What a network adds to the fitted prior (docs/reference/methods/intrinsicdecomp.md, 2): three vec4 a network pixel.
#define FIELDS_EDGES 0  // ln a and ln b of the edge to the right, and of that down
#define FIELDS_CUES 1   // ln a and ln b by cue 0 of the edge, and by cue 1
#define FIELDS_CELL 2   // ln v, V, ln g, -
#define FIELDS_STRIDE 3
#define FIELDS 11  // numbers of them
