// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/same_surface.glsl"

// What is known of a frame's reflectance on the finest level (known.glsl), in the solver's scale: r_model = ln R − ln c. B is 1 on the
// background, the known surfaces, and 0 where the frame sees something else by its depth; less where its color differs.
PLANE_IN(0, image);
PLANE_IN(1, reflectance);  // what is known: ln R; w: confidence, 0: unknown
SCALAR_IN(2, known_depth);
SCALAR_IN(3, depth);       // of the frame, meters
PLANE_IN(4, valid);        // .x: 0 if nothing of that is
PLANE_IN(5, scale);        // of the frame before: .x = ln c, .y: 0 if there is none (scale.glsl)
PLANE_OUT(6, known_targets);
layout(push_constant) uniform Push {
  ivec2 size;
  ivec2 known_size;
  float log_floor, chroma_floor;
} push;

float mean3(vec3 v) { return (v.r + v.g + v.b) * (1.0 / 3.0); }

/// 1 for two colors of one chroma, ½ at the distance kColor, measured as by the guide of intrinsicdecomp.
float color_share(vec3 a, vec3 b) {
  vec3 off = log(a + push.chroma_floor) - log(b + push.chroma_floor);
  off -= mean3(off);
  return 1.0 / (1.0 + 1.5 * dot(off, off) / (kColor * kColor));
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  ivec2 from = ivec2((2u * uvec2(at) + 1u) * uvec2(push.known_size) / (2u * uvec2(push.size)));
  int k = from.y * push.known_size.x + from.x;
  vec4 known = FETCH(reflectance, k), scale_before = FETCH(scale, 0);
  bool background = FETCH(valid, 0).x > 0.0 && scale_before.y > 0.0 && known.w > 0.0 &&
                    same_surface(FETCH1(depth, k), FETCH1(known_depth, k));
  // The known color where the frame is as bright as here.
  vec3 light = FETCH(image, n).rgb, i = log(max(light, push.log_floor));
  float share = background ? color_share(light, exp(min(known.rgb - mean3(known.rgb) + mean3(i), 20.0))) : 0.0;
  STORE(known_targets, n, background ? share * vec4(known.rgb - scale_before.x, 1.0) : vec4(0.0));
}
