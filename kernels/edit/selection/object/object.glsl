// SPDX-License-Identifier: LGPL-2.1-or-later
// Shared by the kernels of object selection (object_selection.hpp; tests/reference/edit/selection/object.hpp has the equations).
#include "image/finite.glsl"

// Bins of color: Oklab lightness, a, b from kBinLow on. Colors beyond the last bin are in it.
const ivec3 kBins = ivec3(10, 24, 24);
const int kBinCount = 5760;
const vec3 kBinLow = vec3(0.0, -0.3, -0.3), kBinHigh = vec3(1.05, 0.3, 0.3);

const float kStartColor = 0.5;    // share of the largest density under strokes from which on a color is the object's at first
const float kOwnColor = 0.2;      // the same of the object's density, for colors that are not the background's
const float kDensityFloor = 0.002;  // of that density: rarer colors are neither the object's nor the background's
const float kPriorWeight = 0.05;  // of a certain cell's color, against edges
const float kPriorFloor = 1e-3;
const float kSeedWeight = 10.0;
const float kEdgeWeight = 2.0;
const float kEdgeScale = 0.04;    // difference of Oklab colors that separates neighbors

// Shortest paths from strokes: a step to a neighbor, in edges of kEdgeScale; the difference that makes a cell one's own; none.
const float kStep = 0.005, kPathScale = 0.3, kNoPath = 1e6;
const float kPathWeight = 0.05;   // of what strokes decide where color is uncertain
// `memory`: the color of a cell when strokes were drawn, and in w what they decide: 1 to -1, or kUnderStroke.
const float kMemoryReach = 0.08;  // change of color from which on a cell forgets them
const float kUnderStroke = 2.0;

const uint kSeedAdd = 1u, kSeedSubtract = 2u;
const uint kSeedAround = 3u;      // around a closed stroke that adds: subtracts what is not selected yet
const uint kFullCount = 255u;     // counts of a whole cell of the object

// Words of `status`: the region in cells, for the next frame and for stats.
const int kArea = 0, kSumX = 1, kSumY = 2, kLeft = 3, kTop = 4, kRight = 5, kBottom = 6;  // kLeft, kTop: from the other border
const int kStatusWords = 8;
const int kCoarse = 4;            // cells along a side of a block of `occupied`

// Densities of color in `model`, in this order, and their largest values in `totals`.y: of the object, of the background, and under the
// strokes that add and that subtract.
const int kObjectDensity = 0, kBackgroundDensity = 1, kAddedDensity = 2, kSubtractedDensity = 3, kDensities = 4;

int bin_of(vec3 color) {
  ivec3 bin = clamp(ivec3(floor((color - kBinLow) / (kBinHigh - kBinLow) * vec3(kBins))), ivec3(0), kBins - 1);
  return (bin.x * kBins.y + bin.y) * kBins.z + bin.z;
}
