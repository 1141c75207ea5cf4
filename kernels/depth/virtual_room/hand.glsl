// SPDX-License-Identifier: LGPL-2.1-or-later
// A hand of capsules: all that is within a radius of a line (hand.hpp). Meters. Needs HAND(index), which reads them, push.parts, and
// room.glsl.
const uint kHandStride = 3u;  // of a part, in vec4. xyz: an end, w: radius; xyz: the other end; rgb: reflectance
const float kHandOpen = 0.7;  // of the light from all around

// Where a ray enters a ball; kFar if it does not.
float meets_ball(vec3 center, float radius, vec3 from, vec3 along) {
  vec3 o = from - center;
  float a = dot(along, along), b = dot(o, along), q = b * b - a * (dot(o, o) - radius * radius);
  float t = q > 0.0 ? (-b - sqrt(q)) / a : 0.0;
  return t > 0.0 ? t : kFar;
}
float meets_part(uint i, vec3 from, vec3 along) {
  vec4 first = HAND(int(kHandStride * i));
  vec3 line = HAND(int(kHandStride * i) + 1).xyz - first.xyz, o = from - first.xyz;
  // The cylinder between the balls at both ends, across its axis.
  float square = dot(line, line), slope = dot(line, along), start = dot(line, o);
  float a = square * dot(along, along) - slope * slope, b = square * dot(along, o) - start * slope;
  float q = b * b - a * (square * dot(o, o) - start * start - first.w * first.w * square);
  float t = q > 0.0 && a > 0.0 ? (-b - sqrt(q)) / a : 0.0, at = start + t * slope;
  float side = t > 0.0 && at > 0.0 && at < square ? t : kFar;
  return min(side, min(meets_ball(first.xyz, first.w, from, along), meets_ball(first.xyz + line, first.w, from, along)));
}

// The hand in front of `hit`, as solid push.solids + part.
Hit nearest_part(Hit hit, vec3 from, vec3 along) {
  for (uint i = 0u; i < push.parts; ++i) {
    float t = meets_part(i, from, along);
    if (t < hit.along) hit = Hit(t, push.solids + i);
  }
  return hit;
}
float open_past_hand(vec3 from, vec3 along, float reach) {
  float result = 1.0;
  for (uint i = 0u; i < push.parts; ++i) result = meets_part(i, from, along) < reach ? 0.0 : result;
  return result;
}
vec3 normal_of_part(uint i, vec3 at) {
  vec3 first = HAND(int(kHandStride * i)).xyz, line = HAND(int(kHandStride * i) + 1).xyz - first;
  float t = clamp(dot(at - first, line) / max(dot(line, line), 1e-12), 0.0, 1.0);
  return normalize(at - first - t * line);
}
