// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#define TABLE_SLOT 0
#include "thesis/chapter5/energy/table.glsl"

// The start: r = r_cluster (without clusters ln I/max I), indirect layers that share indirect_start of the direct one, T_0
// the least-squares fit of I.
PLANE_IN(1, image);
PLANE_IN(2, targets);
PLANE_IN(3, features);
PLANE_OUT(4, state);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int plane = push.size.x * push.size.y;
  int n = at.y * push.size.x + at.x;
  float share = push.indirect_start / float(max(push.layers, 1));
  vec3 light = vec3(1.0);  // of T_0 = 1
  for (int g = 1; g <= kGroups; ++g) light += share * (base_colors(g) * vec4(1.0)).rgb;
  vec3 i = FETCH(image, n).rgb;
  float largest = max(max(i.r, i.g), max(i.b, push.log_floor));
  vec3 r = FETCH(features, n).w < 0.0 ? log(max(i, push.log_floor * largest) / largest) : FETCH(targets, n).rgb;
  vec3 model = exp(r) * light;
  float direct = dot(model, i) / dot(model, model);
  STORE(state, n, vec4(r, direct));
  for (int g = 1; g <= kGroups; ++g) {
    mat4 b = base_colors(g);
    STORE(state, g * plane + n, share * direct * vec4(b[0].w, b[1].w, b[2].w, b[3].w));
  }
}
