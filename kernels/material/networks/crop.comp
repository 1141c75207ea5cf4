// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "material/layers/lime.glsl"
#include "image/srgb.glsl"
#include "image/finite.glsl"

// A square of the frame as input of SegmentationNet: side x side points, each the mean light of its area in sRGB. The
// frame's border is extended beyond it.
PLANE_IN(0, frame);
PLANE_OUT(1, image);  // a network's input: behind one zero
layout(push_constant) uniform Push {
  ivec2 size;    // of the frame
  vec2 corner;   // of the square, pixels
  float pixels;  // of the frame along a point
  int side;
} push;

const int kMaxTaps = 12;  // along one side of a point; if it covers more pixels they are spread over it

void main() {
  int i = int(line_index());
  if (i >= push.side * push.side) return;
  int taps = clamp(int(ceil(push.pixels)), 1, kMaxTaps);
  vec2 first = push.corner + push.pixels * vec2(i % push.side, i / push.side);
  float step_ = push.pixels / float(taps);
  vec3 sum = vec3(0.0);
  for (int y = 0; y < taps; ++y)
    for (int x = 0; x < taps; ++x) {
      ivec2 at = clamp(ivec2(floor(first + step_ * (vec2(x, y) + 0.5))), ivec2(0), push.size - 1);
      sum += finite(FETCH(frame, at.y * push.size.x + at.x)).rgb;
    }
  STORE(image, 1 + i, vec4(to_srgb(sum / float(taps * taps)), 0.0));
}
