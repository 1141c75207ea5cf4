// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "edit.glsl"
#include "image/light_color.glsl"

// Applies to a layer v what an effect changed in a picture of it. q is the picture as it was sent, min(gain v, 1) in few
// bits, p as it came back, both linear; per channel
//
//   v' = v p / q              p < q: what the bits of q lost, or clipped, scales with the picture
//        v + (p − q) / gain   p > q
//        v                    p = q
//   v'' = v + w (v' − v)      w = strength · matte
//
// A picture of another size changes v by the bilinear mean of what its four nearest pixels change.
layout(constant_id = 1) const uint LAYER = 0u;
layout(constant_id = 2) const bool LIGHT = false;   // light has a layer of its own
layout(constant_id = 3) const bool LAMP = false;    // direct light has a color
layout(constant_id = 4) const bool SLOPE = false;   // light has a color by its shading
layout(constant_id = 5) const bool TINT = false;    // the color of light is written, too
layout(constant_id = 6) const bool MATTE = false;
layout(constant_id = 7) const bool SCALED = false;  // the picture has another size
layout(constant_id = 8) const bool GAMUT = false;   // the picture has other primaries
const uint kReflectance = 0u, kShading = 1u, kDirect = 2u, kIndirect = 3u, kMask = 4u;

PLANE_IN(0, sent);
PLANE_IN(1, returned);
PLANE_IN(2, before);  // R, S; kMask: the mask layer
PLANE_IN(3, light);
PLANE_IN(4, lamp);   // one pixel
PLANE_IN(5, slope);  // one pixel
PLANE_IN(6, matte);
PLANE_OUT(7, edited);  // as `before`
PLANE_OUT(8, tinted);  // as `light`
layout(push_constant) uniform Push {
  vec4 red, green, blue;  // rows of the matrix to the layers' primaries
  uvec2 size, from;       // of the layers, of the picture
  float inverse_gain, strength;
  uint first_row;
} push;

const float kTiny = 1e-20;  // light below has no color

vec3 picture_at(vec4 color) {
  vec3 c = finite(color).rgb;
  if (!GAMUT) return c;
  return finite(vec4(dot(push.red.rgb, c), dot(push.green.rgb, c), dot(push.blue.rgb, c), 0.0)).rgb;
}

// v' − v by pixel n of the picture.
vec3 change_by(vec3 v, int n) {
  vec3 p = picture_at(FETCH(returned, n)), q = picture_at(FETCH(sent, n));
  return mix((p - q) * push.inverse_gain, v * (p / max(q, vec3(kTiny))) - v, lessThan(p, q));
}

// v' − v at a pixel of the layers.
vec3 change_at(vec3 v, uvec2 at) {
  if (!SCALED) return change_by(v, int(at.y * push.size.x + at.x));
  vec2 place = (vec2(at) + 0.5) * vec2(push.from) / vec2(push.size) - 0.5;
  vec2 t = fract(place);
  ivec2 last = ivec2(push.from) - 1, low = clamp(ivec2(floor(place)), ivec2(0), last);
  ivec2 high = clamp(ivec2(floor(place)) + 1, ivec2(0), last), row = int(push.from.x) * ivec2(low.y, high.y);
  return mix(mix(change_by(v, row.x + low.x), change_by(v, row.x + high.x), t.x),
             mix(change_by(v, row.y + low.x), change_by(v, row.y + high.x), t.x), t.y);
}

vec3 light_of(float shading) { return SLOPE ? colored_light(FETCH(slope, 0), shading) : vec3(shading); }

// The light S C L of a pixel changes: brightness goes to S if it is shading that was changed, the rest to L.
void change_light(inout float shading, inout vec4 l, uvec2 at, float weight) {
  vec3 unit = light_of(shading), white = LAMP ? finite(FETCH(lamp, 0)).rgb : vec3(1.0);
  vec3 direct = unit * l.w * white, total = unit * l.rgb;
  vec3 v = LAYER == kDirect ? direct : LAYER == kIndirect ? max(total - direct, vec3(0.0)) : total;
  vec3 change = weight * change_at(v, at);
  if (all(equal(change, vec3(0.0)))) return;
  vec3 now = clamp(total + change, vec3(0.0), vec3(kLargest));
  if (LAYER == kShading || shading == 0.0)
    shading = min(mean3(total) > kTiny ? shading * (mean3(now) / mean3(total)) : mean3(now), kLargest);
  if (!TINT) return;
  unit = light_of(shading);
  l.rgb = mix(l.rgb, min(now / max(unit, vec3(kTiny)), vec3(kLargest)), greaterThan(unit, vec3(0.0)));
  float reach = mean3(unit * white);
  if (LAYER == kDirect && reach > 0.0) l.w = clamp(mean3(direct + change) / reach, 0.0, kLargest);
}

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    int n = int(y * push.size.x + at.x);
    uvec2 here = uvec2(at.x, y);
    vec4 now = finite(FETCH(before, n));
    float weight = push.strength * (MATTE ? min(finite(FETCH(matte, n)).x, 1.0) : 1.0);
    if (LAYER == kReflectance) {
      now.rgb = clamp(now.rgb + weight * change_at(now.rgb, here), vec3(0.0), vec3(kLargest));
    } else if (LAYER == kMask) {
      now.x = clamp(now.x + weight * mean3(change_at(now.xxx, here)), 0.0, 1.0);
    } else {
      vec4 l = LIGHT ? finite(FETCH(light, n)) : vec4(1.0);
      change_light(now.w, l, here, weight);
      if (TINT) STORE(tinted, BY_ROWS(n), l);
    }
    STORE(edited, BY_ROWS(n), now);
  }
}
