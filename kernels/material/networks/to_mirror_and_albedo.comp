// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "material/layers/lime.glsl"
#include "image/finite.glsl"

// Output of SpecularNet on the object: input of MirrorNet and, with the image, of AlbedoNet.
PLANE_IN(0, masked);
PLANE_IN(1, specular);
PLANE_OUT(2, mirror_in);
PLANE_OUT(3, albedo_in);
layout(push_constant) uniform Push { int count; } push;

void main() {
  int i = int(line_index());
  if (i >= push.count) return;
  vec4 here = FETCH(masked, 1 + i);
  float code = here.w * finite(FETCH(specular, 1 + i)).x;
  STORE(mirror_in, 1 + i, vec4(code, 0.0, 0.0, 0.0));
  STORE(albedo_in, 1 + i, vec4(here.rgb, code));
}
