// SPDX-License-Identifier: LGPL-2.1-or-later
// A pinhole camera: x right, y down, z forward; pixel centers at whole numbers. A pose is two vec4: the unit quaternion (xyz, w) that
// turns directions of the camera into the world's, and the camera's place in the world, in meters.
vec3 turned(vec4 q, vec3 v) {
  vec3 t = 2.0 * cross(q.xyz, v);
  return v + q.w * t + cross(q.xyz, t);
}
vec4 product(vec4 p, vec4 q) { return vec4(p.w * q.xyz + q.w * p.xyz + cross(p.xyz, q.xyz), p.w * q.w - dot(p.xyz, q.xyz)); }
vec3 to_world(vec4 rotation, vec4 place, vec3 p) { return turned(rotation, p) + place.xyz; }
vec3 to_camera(vec4 rotation, vec4 place, vec3 p) { return turned(vec4(-rotation.xyz, rotation.w), p - place.xyz); }
// lens: focal lengths and center, in pixels.
vec2 projected(vec4 lens, vec3 p) { return lens.xy * p.xy / p.z + lens.zw; }
// Whether a ball may be in sight of a camera of `size` pixels that sees as far as max_depth.
bool in_sight(vec4 lens, uvec2 size, float max_depth, vec3 center, float radius) {
  // The distance of the center to each plane of the frustum.
  vec2 low = (vec2(-0.5) - lens.zw) / lens.xy, high = (vec2(size) - 0.5 - lens.zw) / lens.xy;
  vec2 beyond = max((low * center.z - center.xy) / sqrt(1.0 + low * low), (center.xy - high * center.z) / sqrt(1.0 + high * high));
  return center.z > -radius && center.z < max_depth + radius && max(beyond.x, beyond.y) < radius;
}
vec3 ray_of(vec4 lens, vec2 pixel) { return vec3((pixel - lens.zw) / lens.xy, 1.0); }
