// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "palette.glsl"

// Averages the histogram over time and sets the frame's counts back to zero.
WORD_INOUT(0, counts);
PLANE_IN(1, before);
PLANE_OUT(2, histogram);

void main() {
  int n = int(line_index());
  if (n >= kBinCount) return;
  float pixels = float(LOAD(counts, 4 * n));
  vec3 inside = vec3(LOAD(counts, 4 * n + 1), LOAD(counts, 4 * n + 2), LOAD(counts, 4 * n + 3)) / push.fraction_scale;
  vec3 corner = vec3(n / (kBins * kBins), n / kBins % kBins, n % kBins);
  vec4 now = vec4(pixels, (corner * pixels + inside) / float(kBins));
  vec4 old = push.first == 1 ? now : FETCH(before, n);
  vec4 mean = old + (pixels > 0.0 ? push.decay : push.fade) * (now - old);
  STORE(histogram, n, mean.x < 1e-3 ? vec4(0.0) : mean);  // bins below a thousandth of a pixel are cleared
  for (int i = 0; i < 4; ++i) STORE(counts, 4 * n + i, 0u);
}
