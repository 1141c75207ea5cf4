// SPDX-License-Identifier: LGPL-2.1-or-later
// The user's strokes (thesis, 4.5; tests/reference/intrinsic/strokes.hpp). A mask holds, for every pixel or cell, the stroke that it
// belongs to and how firmly, as one float: 0 is no stroke, else the stroke's number from 1 on and half the weight.

// A stroke: first cell that it may cover and the one after the last, along x and y; kind, whether it is filled (1 or 0), whether it
// is drawn, -; linear RGB; the cells as above without what is filled; the map from a place in pixels to a texel, as a complex number
// and its offset; and its patch: texels along x and y, its first one / 16.
#define STROKE_BOUNDS 0
#define STROKE_KIND 1
#define STROKE_COLOR 2
#define STROKE_BOX 3
#define STROKE_MAP 4
#define STROKE_PATCH 5
#define STROKE_STRIDE 6
#define STROKE_FILL 1  // of STROKE_KIND
#define KIND_SHADING 0
#define KIND_REFLECTANCE 1
#define KIND_RECOLOR 2

// Reflectance that a stroke fills is nearer to its mean, Euclidean distance of linear RGB (thesis, 4.5.2).
const float kFillDistance = 0.1;

// Sums over a stroke read every so many rows: all if it is not large. (llvmpipe ends the loops of an invocation after 65535 rounds.)
const uint kMaxPacks = 65536u;
uint rows_apart(uint columns, uint rows) { return max((columns * rows + kMaxPacks - 1u) / kMaxPacks, 1u); }

vec4 number_of(vec4 mask) { return floor(mask); }
vec4 weight_of(vec4 mask) { return 2.0 * fract(mask); }
