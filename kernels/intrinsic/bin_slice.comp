#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "bins.glsl"

// The right-hand side of energy.glsl from the bins: f = base + g (m - r_bin), with s itself as the target where no bin
// around a pixel's chroma is filled. One quad an invocation.
PLANE_IN(0, level0);
PLANE_IN(1, value);
PLANE_IN(2, base);
PLANE_IN(3, shading);
PLANE_IN(4, means);
PLANE_OUT(5, system);
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 position = grid_position(quads);
  if (position.y >= push.size.y) return;
  int at = int(position.y * quads + position.x);
  vec4 target = FETCH(shading, at);
  for (uint k = 0u; k < 4u; ++k) {
    uint pixel = position.y * push.size.x + min(4u * position.x + k, push.size.x - 1u);
    vec4 guide = FETCH(level0, int(pixel));
    vec2 fraction;
    uvec2 bin = bin_of(guide.yz, fraction);
    vec4 mean = FETCH(means, int(bin.y * uint(kBins) + bin.x));
    vec4 hat = mix(vec4(0.0), hats(fraction), lessThan(mean, vec4(kEmptyBin)));
    float known = dot(hat, vec4(1.0));
    float found = guide.x - dot(hat, mix(vec4(0.0), mean, lessThan(mean, vec4(kEmptyBin)))) / max(known, 1e-20);
    target = vec4(target.yzw, known > 0.0 ? found : target.x);
  }
  vec4 g = FETCH(value, VALUE_STRIDE * at + VALUE_CHROMA);
  STORE(system, SYSTEM_STRIDE * at + SYSTEM_RHS, FETCH(base, at) + g * target);
}
