// SPDX-License-Identifier: LGPL-2.1-or-later
// Regions that were assigned to a wrong base color (thesis, 5.5.2.1), filled over connected components of equal cluster. A region is the union of the components that its clicked pixel lies in, or, one frame on, those of its pixels that still
// have its cluster.

const int kMaxRegions = 16;  // with number 0, which is none
const int kMaxClicks = 16;   // a frame

// A component is claimed by the word of a region: its number plus kMaxRegions times its rank, of which the highest wins
// (MarkedRegions).
uint claiming_region(uint claim) { return claim % uint(kMaxRegions); }

// What is counted of a region: its pixels, then whether it still claimed any, though another one may have won them.
int pixels_at(uint number) { return int(number); }
int claimed_at(uint number) { return kMaxRegions + int(number); }

// The host's orders for a frame are words: for each region the slot of its color + 1, then its claim if it continues from
// the frame before, or 0, then (x, y, claim, the only cluster that it may have + 1, or 0) of each click.

layout(push_constant) uniform Push {
  ivec2 size;
  int clicks;
} push;
