// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "edit/edit.glsl"
#include "image/light_color.glsl"

// Puts an object C of coverage a, and the share h of light that it hides, into a frame I = R S L and its layers, as if the camera had
// seen the object there:
//
//   I' = a C + (1 - a) I        R S L of the model becomes a C + (1 - a) R S L, that of the edit a C + (1 - a) R S (1 - h) L
//
// S of the object is its mean over that of its diffuse albedo, so that R is the albedo in white light without highlights.
PLANE_IN(0, frame);
PLANE_IN(1, model);
PLANE_IN(2, intrinsic);
PLANE_IN(3, model_light);
PLANE_IN(4, light);
PLANE_IN(5, slope);
PLANE_IN(6, picture);  // of the object's window: RGB times coverage, coverage
PLANE_IN(7, hidden);   // cast.comp
PLANE_OUT(8, inserted_frame);
PLANE_OUT(9, inserted_model);
PLANE_OUT(10, inserted);
layout(push_constant) uniform Push {
  uvec2 size;
  uvec2 view;                 // `hidden` has each step-th pixel of it
  ivec2 window, window_size;  // of the picture
  uint step;
  float albedo;               // mean of the diffuse albedo
  uint has_light, has_slope;  // what is not there is white
  uint first_row;
} push;

#define SEEN(index) FETCH(hidden, index)
#include "camera/between_pixels.glsl"

const float kMinLight = 1e-9;

vec3 light_of(float shading, vec3 color) {
  return (push.has_slope == 1u ? colored_light(FETCH(slope, 0), shading) : vec3(shading)) * color;
}
// Layers with the object over them.
vec4 over(vec4 object, float shading, vec4 layers, vec3 color) {
  vec3 sum = object.rgb + (1.0 - object.a) * layers.rgb * light_of(layers.w, color);
  float both = min(object.a * shading + (1.0 - object.a) * layers.w, kLargest);
  return vec4(min(sum / max(light_of(both, color), vec3(kMinLight)), vec3(kLargest)), both);
}

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    int n = int(y * push.size.x + at.x);
    vec4 seen = FETCH(frame, n), before = FETCH(model, n), now = FETCH(intrinsic, n);
    float share = between_pixels(uvec2(at.x, y), push.size, push.view, push.step).x;
    if (share > 0.0) now.w *= 1.0 - share;
    ivec2 own = ivec2(at.x, y) - push.window;
    if (all(greaterThanEqual(own, ivec2(0))) && all(lessThan(own, push.window_size))) {
      vec4 object = finite(FETCH(picture, own.y * push.window_size.x + own.x));
      if (object.a > 0.0) {
        bool colored = push.has_light == 1u;
        vec3 was = colored ? finite(FETCH(model_light, n)).rgb : vec3(1.0), is = colored ? finite(FETCH(light, n)).rgb : vec3(1.0);
        float shading = mean3(object.rgb) / (object.a * push.albedo);
        seen = finite(seen);
        seen.rgb = min(object.rgb + (1.0 - object.a) * seen.rgb, vec3(kLargest));
        before = over(object, shading, finite(before), was);
        now = over(object, shading, finite(now), is);
      }
    }
    STORE(inserted_frame, BY_ROWS(n), seen);
    STORE(inserted_model, BY_ROWS(n), before);
    STORE(inserted, BY_ROWS(n), now);
  }
}
