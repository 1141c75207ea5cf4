// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/same_surface.glsl"
#include "depth/tracking/tracking.glsl"
#include "touch.glsl"

// Where a frame shows something in front of the scene (thesis, 4.5.1): its depth is less than all that the view has within one pixel, as
// edges may be off by that. One pixel an invocation.
PLANE_IN(0, surface);     // of the frame: w: depth
SCALAR_IN(1, view_depth); // from the same place
PLANE_IN(2, layers);      // rgb: its reflectance
PLANE_IN(3, found);
WORD_OUT(4, kinds);
WORD_INOUT(5, any);       // set to 1 if there is such a pixel
layout(push_constant) uniform Push { uvec2 size; } push;

const float kClose = 0.004;      // meters, and kCloseSteps standard deviations of the sensor: a finger on a surface is as near
const float kCloseSteps = 1.0;

// The rule for RGB of 8 bits in daylight (Kovac et al. 2003; Vezhnevets et al. 2003), on reflectance: skin in shadow is too dark for it.
bool is_skin(vec3 linear) {
  vec3 c = clamp(linear, 0.0, 1.0);
  vec3 rgb = 255.0 * mix(12.92 * c, 1.055 * pow(max(c, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
  float low = min(rgb.r, min(rgb.g, rgb.b)), high = max(rgb.r, max(rgb.g, rgb.b));
  return rgb.r > 95.0 && rgb.g > 40.0 && rgb.b > 20.0 && high - low > 15.0 && abs(rgb.r - rgb.g) > 15.0 && rgb.r > rgb.g && rgb.r > rgb.b;
}

void main() {
  uint line = line_index();
  ivec2 pixel = ivec2(line % push.size.x, line / push.size.x), last = ivec2(push.size) - 1;
  if (pixel.y > last.y) return;
  float z = FETCH(surface, int(line)).w, nearest = 1e9;
  for (int n = 0; n < 9; ++n) {
    ivec2 p = clamp(pixel + ivec2(n % 3, n / 3) - 1, ivec2(0), last);
    float there = FETCH1(view_depth, p.y * int(push.size.x) + p.x);
    nearest = there > 0.0 ? min(nearest, there) : nearest;
  }
  bool known = FETCH1(view_depth, int(line)) > 0.0, measured = z > 0.0 && FETCH(found, int(kFound)).x > 0.0;
  float gap = nearest - z, noise = noise_at(z);
  bool front = measured && known && gap > kMargin + kSteps * noise, maybe = measured && (!known || gap > kClose + kCloseSteps * noise);
  uint kind = (front ? TOUCH_FRONT : 0u) | (maybe ? TOUCH_MAYBE : 0u) | (is_skin(FETCH(layers, int(line)).rgb) ? TOUCH_SKIN : 0u);
  STORE(kinds, line, kind);
  if (front) STORE(any, 0, 1u);
}
