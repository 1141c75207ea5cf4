// SPDX-License-Identifier: LGPL-2.1-or-later
// Guided upsampling of log shading (He and Sun, Fast Guided Filter, 2015): around every pixel of the half-size frame
// s = a m + b, the least-squares line through the 3 x 3 pixels there, a between 0 (the step is paint) and 1 (it is light);
// the frame's own m then says where, between two half-size pixels, a step of s lies.
const float kFlatVariance = 3e-3;  // of m, log units squared: where it varies less, a goes to 0
const float kDarkest = -16.0;      // log shading of a black pixel
