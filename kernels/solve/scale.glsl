// SPDX-License-Identifier: LGPL-2.1-or-later
// The scale of reflectance is free: R c and S / c make the same picture. ln c = ln(white level) + offset. The offset keeps the
// brightness of what stays in view (scale_track.comp, scale_update.comp).
//
// Of a cell: mean log intensity m, chroma (two log ratios), mean log reflectance before scaling. One vec4.

// The state from frame to frame, three vec4:
#define SCALE_NOW 0     // ln c, 1 once it is known, offset, offset that the frame alone would get
#define SCALE_MOTION 1  // the points' common motion (cells a frame), mean share of bright points, 1 if the points go on
#define SCALE_SHIFT 2   // last change of the offset, which the references still need, -, -, -
#define SCALE_SIZE 3

// Of a point, two vec4: place (cells), its log reflectance in the output less ln(white level), frames since it began (-1: lost);
// and its chroma when it began.
#define POINT_PLACE 0
#define POINT_COLOR 1
#define POINT_STRIDE 2

// Measurement of a point, two vec4: the offset that keeps its reflectance, its weight, the weight of its motion, 1 if it is
// bright; and its motion, 1 if it was found again.
#define SAMPLE_OFFSET 0
#define SAMPLE_MOTION 1
#define SAMPLE_STRIDE 2
