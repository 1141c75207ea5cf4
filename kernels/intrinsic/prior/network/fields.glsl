// SPDX-License-Identifier: LGPL-2.1-or-later
// What a network adds to the fitted prior of a cell (docs/reference/methods/intrinsicdecomp.md, 2): a vec4 a network pixel, ln v, V, ln g.
#define FIELDS 3
