// SPDX-License-Identifier: LGPL-2.1-or-later
// The user's strokes in a system (energy.glsl). The includer defines STROKE_BINDING, of two inputs.
layout(constant_id = 1) const bool kStrokes = false;  // whether there are any; else the inputs are not read

// Of every pixel, in rows padded to packs of four: 0, or the number of its stroke, from 1 on, plus half of its weight.
PLANE_IN(STROKE_BINDING, stroke_mask);
// Of every stroke: its auxiliary variable, r or (s, 0, 0); 1 if that is r, 0 if it is s.
PLANE_IN(STROKE_BINDING + 1, stroke_means);

const float kUserWeight = 1000.0;  // w_u (4.3)

/// The target of r or s of a pixel, its weight in the energy, and whether it is one of r.
struct StrokeTarget {
  vec3 value;
  float weight;
  bool reflectance;
};

StrokeTarget stroke_target(int x, int y) {
  StrokeTarget target = StrokeTarget(vec3(0.0), 0.0, false);
  if (!kStrokes) return target;
  float mask = FETCH(stroke_mask, y * ((push.size.x + 3) / 4) + x / 4)[x & 3];
  if (mask <= 0.0) return target;
  vec4 mean = FETCH(stroke_means, int(mask) - 1);
  return StrokeTarget(mean.rgb, kUserWeight * 2.0 * fract(mask), mean.w > 0.0);
}

/// The weight of a target of s at a pixel.
float shading_weight(int x, int y) {
  StrokeTarget target = stroke_target(x, y);
  return target.reflectance ? 0.0 : target.weight;
}
