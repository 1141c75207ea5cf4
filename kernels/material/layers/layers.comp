// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "lime.glsl"
#include "image/finite.glsl"

// The frame's layers: diffuse light of the object and its mask; specular light and mirror image. Values are bilinear
// between the points of the square. The mask follows the pixel's color by planes, the specular layer its smallest
// channel by lines, so that edges match the frame. The specular layer is at most the smallest channel. In clipped
// channels, the diffuse light is at least that around the highlight, so that the layers exceed the clipped value.
layout(constant_id = 1) const bool kFound = true;  // whether there is an object
PLANE_IN(0, frame);
PLANE_IN(1, planes);    // slopes and offset of the mask's probability by color
PLANE_IN(2, codes);     // of the mirror image in y; behind one zero, as networks have them
PLANE_IN(3, lines);     // slope and offset of the specular layer
PLANE_IN(4, under);     // diffuse light without gaps
PLANE_OUT(5, diffuse);  // linear RGB of the frame without the specular layer; w: mask
PLANE_OUT(6, gloss);    // specular, mirror; linear
layout(push_constant) uniform Push {
  ivec2 size;
  vec2 corner;
  float pixels;
  int side;
  uint first_row;
} push;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, push.first_row);
  if (pixel.x >= push.size.x) return;
  int i = pixel.y * push.size.x + pixel.x;
  vec3 rgb = finite(FETCH(frame, i)).rgb;
  float mask = 0.0;
  vec3 specular = vec3(0.0);
  float mirror = 0.0;
  vec2 at = (vec2(pixel) + 0.5 - push.corner) / push.pixels;
  if (kFound && all(greaterThanEqual(at, vec2(0.0))) && all(lessThan(at, vec2(push.side)))) {
    vec2 between = clamp(at - 0.5, vec2(0.0), vec2(push.side - 1));
    ivec2 low = ivec2(between), high = min(low + 1, push.side - 1);
    vec2 share = between - vec2(low);
    int a = low.y * push.side + low.x, b = low.y * push.side + high.x, c = high.y * push.side + low.x,
        d = high.y * push.side + high.x;
    vec4 plane = mix(mix(FETCH(planes, a), FETCH(planes, b), share.x),
                     mix(FETCH(planes, c), FETCH(planes, d), share.x), share.y);
    mask = smoothstep(0.25, 0.75, dot(plane, vec4(guide_of(rgb), 1.0)));
    float code = mix(mix(FETCH(codes, 1 + a).y, FETCH(codes, 1 + b).y, share.x),
                     mix(FETCH(codes, 1 + c).y, FETCH(codes, 1 + d).y, share.x), share.y);
    vec2 line = mix(mix(FETCH(lines, a).xy, FETCH(lines, b).xy, share.x),
                    mix(FETCH(lines, c).xy, FETCH(lines, d).xy, share.x), share.y);
    float lowest = min(rgb.r, min(rgb.g, rgb.b));
    float layer = clamp(mask * (line.x * lowest + line.y), 0.0, lowest);
    vec3 base = mix(mix(FETCH(under, a).rgb, FETCH(under, b).rgb, share.x),
                    mix(FETCH(under, c).rgb, FETCH(under, d).rgb, share.x), share.y);
    vec3 under_it = min(base * smoothstep(kClips.x, kClips.y, rgb), rgb);
    specular = min(vec3(layer), rgb - under_it);
    mirror = mask * decode(code);
  }
  STORE(diffuse, BY_ROWS(i), vec4(rgb - specular, mask));
  STORE(gloss, BY_ROWS(i), vec4(specular, mirror));
}
