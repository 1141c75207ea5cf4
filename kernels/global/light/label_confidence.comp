// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "global/model/model.glsl"
#include "residual.glsl"

// Labels of the grid's points, by the chroma without their tint; the residual beyond their base color, and the confidence that it
// is light.
PLANE_IN(0, points);
PLANE_IN(1, tints);
WORD_IN(2, slots);  // of bins
PLANE_IN(3, scene);
WORD_OUT(4, labels);
PLANE_OUT(5, raw);  // residual, confidence
layout(push_constant) uniform Push {
  int count;
  float residual_sigma, tint_sigma;
} push;

void main() {
  int i = int(line_index());
  if (i >= push.count) return;
  vec4 tint = FETCH(tints, i);
  vec2 off = FETCH(points, i).xy - tint.xy;
  uint label = FETCH1(slots, bin_of(off));
  STORE(labels, i, label);
  if (FETCH(scene, SCENE_AMOUNT)[AMOUNT_COLORS] > 1.5) off -= FETCH(scene, SCENE_COLORS + int(label)).xy;
  STORE(raw, i, vec4(off, light_confidence(off, tint.z, FETCH(scene, SCENE_TINT)[TINT_RMS], push.residual_sigma, push.tint_sigma), 0.0));
}
