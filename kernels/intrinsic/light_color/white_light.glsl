// SPDX-License-Identifier: LGPL-2.1-or-later
#include "intrinsic/guide/guide.glsl"
#include "light.glsl"

// A color of the frame, whose mean log intensity is m, as it were in white light: divided by the color that light of its brightness
// has. `now`: LIGHT_NOW.
vec3 in_white_light(vec3 rgb, float m, vec4 now) { return now.x == 0.0 ? rgb : reflectance_in(rgb, 1.0, now.x, m - now.y); }
vec3 in_white_light(vec3 rgb, vec4 now) { return in_white_light(rgb, mean_log(rgb), now); }
