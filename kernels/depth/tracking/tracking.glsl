// SPDX-License-Identifier: LGPL-2.1-or-later
// What tracking found, in vec4.
const uint kFound = 0u;    // x: 1 if the pose is known, 0 if tracking was lost; y: frames since it was lost; z: frames in a row in which it was found
const uint kFit = 1u;      // rms distance of matched points (meters); shares of pixels with a depth: matched, elsewhere; smallest pivot
const uint kMotion = 2u;   // xyz: last shift, meters; w: last turn, radians
const uint kAlike = 3u;    // as agree.comp leaves it
const uint kFoundStride = 4u;
