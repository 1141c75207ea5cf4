// SPDX-License-Identifier: LGPL-2.1-or-later
// Shared by the stylize kernels: E(S) = log2(1 + S / dark), the log of shading in stops, that is 0 in the dark, where the log of S
// would be noise.
const float kDark = 0.05;

float encoded(float s) { return log2(1.0 + s * (1.0 / kDark)); }
float decoded(float e) { return kDark * (exp2(e) - 1.0); }
const float kWhite = 4.39231742;  // E(1)
