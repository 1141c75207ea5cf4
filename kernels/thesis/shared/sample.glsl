// SPDX-License-Identifier: LGPL-2.1-or-later
// Adds samples to the source terms of a pixel: (Σ weight · target, Σ weight) over all targets of its r. The includer defines
// kSampled, the frames to draw from, vec2 sample_feature(int n), packed chromaticity and weight of the samples of pixel n, and
// vec4 other_sources(int n), those to add to.
PLANE_OUT(8, sources);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  vec2 feature = sample_feature(n);
  float spread;
  vec4 sum = draw_samples(n, feature.x, vec3(0.0), kSampled, spread);
  STORE(sources, n, other_sources(n) + feature.y * sum);
}
