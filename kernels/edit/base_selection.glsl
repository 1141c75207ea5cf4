// SPDX-License-Identifier: LGPL-2.1-or-later
// Selection by a base color of bounced light: pixels that are nearer to it in ln chromaticity, before any edit, than to any other
// and to white, which may have no layer. From 0 to 1 as (distance to the nearest other − distance to this one) goes from
// −softness / 2 to softness / 2. Chromaticity is weighted with light as in recolor.comp. Planes use the bindings MODEL_BINDING of
// the including kernel and the one after it.
PLANE_IN(MODEL_BINDING, model);      // R, S before any edit
PLANE_IN(MODEL_BINDING + 1, bases);  // before any edit
const float kWhite = 0.15;      // a base color this near to white is white
const float kBaseFloor = 1e-3;  // of its channels

vec3 log_chroma(vec3 v) { return log(v / mean3(v)); }

float apart(vec3 a, vec3 b) {
  vec3 d = a - b;
  return sqrt(dot(d, d));
}

float base_selection(vec4 layers, int index, float fall_off) {
  vec4 own = finite(FETCH(bases, index));
  if (own.w <= 0.0) return 0.0;
  vec3 chosen = log_chroma(own.rgb + kBaseFloor);
  vec3 c = log_chroma(min(layers.rgb * layers.w, vec3(kLargest)) + kLightFloor);
  float other = apart(chosen, vec3(0.0)) > kWhite ? apart(c, vec3(0.0)) : 1e15;
  for (int k = 0; k < kMaxBases; ++k) {
    vec4 b = finite(FETCH(bases, k));
    if (b.w > 0.0 && k != index) other = min(other, apart(c, log_chroma(b.rgb + kBaseFloor)));
  }
  return falling(0.5 - (other - apart(c, chosen)) * fall_off);
}
