// SPDX-License-Identifier: LGPL-2.1-or-later
// Whether a frame sees what is known of its scene (KnownReflectance), or something in front of it or behind it.
#include "camera/noise.glsl"

const float kMargin = 0.02;  // meters that the depth of the same surface may differ by, ...
const float kSteps = 4.0;    // ... and standard deviations of the sensor
const float kColor = 0.4;    // distance of chroma, natural log units, that halves the weight of what is known

// Of the frame's depth and that of what is known, meters; 0: unknown.
bool same_surface(float here, float there) {
  return here > 0.0 && there > 0.0 && abs(here - there) < kMargin + kSteps * noise_at(here);
}
