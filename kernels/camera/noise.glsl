// SPDX-License-Identifier: LGPL-2.1-or-later
// Standard deviation of the depth of a structured-light sensor, meters, at a depth in meters (Nguyen et al. 2012).
const float kNoise = 0.0012, kNoiseSquare = 0.0019, kNoiseFrom = 0.4;
float noise_at(float depth) { return kNoise + kNoiseSquare * (depth - kNoiseFrom) * (depth - kNoiseFrom); }
