#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "recolor.glsl"

// Recolors the surfaces of one base color of bounced light: what is nearer to it in ln chromaticity, before any edit, than
// to any other and to white, which need not have a layer. Selection goes from 0 to 1 as (distance to the nearest other −
// distance to this one) goes from −softness / 2 to softness / 2. Chromaticity is weighted with light as in recolor.comp.
PLANE_IN(4, model);
PLANE_IN(5, bases);  // before any edit
const int kMaxBases = 16;
const float kWhite = 0.15;  // a base color this near to white is white

vec3 log_chroma(vec3 v) { return log((v + kValueFloor) / (mean3(v) + kValueFloor)); }

vec3 log_chroma_lit(vec4 layers) {
  vec3 light = min(layers.rgb * layers.w, vec3(kLargest)) + kLightFloor;
  return log(light / mean3(light));
}

float apart(vec3 a, vec3 b) {
  vec3 d = a - b;
  return sqrt(dot(d, d));
}

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  vec4 base = finite(FETCH(bases, push.cluster));
  vec3 chosen = log_chroma(base.rgb);
  bool colored = apart(chosen, vec3(0.0)) > kWhite;
  float key_value = mean3(base.rgb) + kValueFloor;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    uint n = y * push.size.x + at.x;
    vec3 c = log_chroma_lit(finite(FETCH(model, int(n))));
    float other = colored ? apart(c, vec3(0.0)) : 1e15;
    for (int k = 0; k < kMaxBases; ++k) {
      vec4 b = finite(FETCH(bases, k));
      if (b.w > 0.0 && k != push.cluster) other = min(other, apart(c, log_chroma(b.rgb)));
    }
    float selection = base.w > 0.0 ? falling(0.5 - (other - apart(c, chosen)) * push.fall_off) : 0.0;
    recolor(n, finite(FETCH(intrinsic, int(n))), selection, key_value);
  }
}
