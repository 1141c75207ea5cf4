// SPDX-License-Identifier: LGPL-2.1-or-later
// The user's strokes (thesis, 4.5 and Eq. 4.7; tests/reference/intrinsic/strokes.hpp). A mask holds, for every pixel or cell, the
// stroke that it belongs to and how firmly, as one float: 0 is no stroke, else the stroke's number from 1 on and half the weight.

// A stroke, two vec4: first cell and the one after the last along x and y; and kind, whether it is filled (1 or 0), -, -.
#define STROKE_BOUNDS 0
#define STROKE_KIND 1
#define STROKE_FILL 1
#define STROKE_STRIDE 2
#define KIND_SHADING 0
#define KIND_REFLECTANCE 1

// Added to the weight of an edge inside a stroke.
const float kStrokeWeight = 1000.0;

// Reflectance that a stroke fills is nearer to its mean, Euclidean distance of linear RGB (thesis, 4.5.2).
const float kFillDistance = 0.1;

vec4 number_of(vec4 mask) { return floor(mask); }
vec4 weight_of(vec4 mask) { return 2.0 * fract(mask); }
