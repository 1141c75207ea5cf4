// SPDX-License-Identifier: LGPL-2.1-or-later
// Guided upsampling of log shading (He and Sun, Fast Guided Filter, 2015): s = a m + b, the least-squares line through the 3 x 3
// half-size pixels around every pixel, with a between 0 (the step is reflectance) and 1 (it is shading). The frame's own m then
// places a step of s between two half-size pixels.
const float kFlatVariance = 3e-3;  // of m, log units squared: below it a goes to 0
const float kDarkest = -16.0;      // log shading of a black pixel
