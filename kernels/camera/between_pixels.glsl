// SPDX-License-Identifier: LGPL-2.1-or-later
// What a pixel of the frame has of a plane of each `step`-th pixel of the view, rgb and depth (0: unknown): the mean, by their distance,
// of those of the four pixels around it that are of the same surface as the nearest one. 0 where nothing is known. Needs SEEN(index),
// which reads the plane.
#include "camera/jump.glsl"

vec3 between_pixels(uvec2 at, uvec2 frame, uvec2 view, uint step) {
  uvec2 grid = (view + step - 1u) / step;
  vec2 place = clamp(((vec2(at) + 0.5) * vec2(view) / vec2(frame) - 0.5) / float(step), vec2(0.0), vec2(grid - 1u));
  ivec2 low = ivec2(place), high = min(low + 1, ivec2(grid) - 1);
  vec2 part = place - vec2(low);
  int above = low.y * int(grid.x), below = high.y * int(grid.x);
  vec4 seen[4] = vec4[](SEEN(above + low.x), SEEN(above + high.x), SEEN(below + low.x), SEEN(below + high.x));
  vec4 weights = vec4((1.0 - part.x) * (1.0 - part.y), part.x * (1.0 - part.y), (1.0 - part.x) * part.y, part.x * part.y);
  float depth = 0.0, most = 0.0;
  for (int i = 0; i < 4; ++i) {
    if (!(seen[i].w > 0.0 && weights[i] > most)) continue;
    most = weights[i];
    depth = seen[i].w;
  }
  vec3 sum = vec3(0.0);
  float total = 0.0;
  for (int i = 0; i < 4; ++i) {
    if (!(seen[i].w > 0.0 && abs(seen[i].w - depth) <= kJump * depth)) continue;
    sum += weights[i] * seen[i].rgb;
    total += weights[i];
  }
  return total > 0.0 ? sum / total : vec3(0.0);
}
