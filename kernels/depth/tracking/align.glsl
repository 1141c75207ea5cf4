// SPDX-License-Identifier: LGPL-2.1-or-later
// Sums of an alignment, kSums vec4: the upper triangle of JᵀWJ row by row (21), JᵀWr (6), for distances alone the sums of Wr² and of W;
// pixels that matched, pixels with a depth, pixels of which the match is elsewhere.
const uint kSums = 8u;
const int kUnknowns = 6;  // turn, then shift
