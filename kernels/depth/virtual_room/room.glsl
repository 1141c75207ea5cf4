// SPDX-License-Identifier: LGPL-2.1-or-later
// A room of boxes and balls, painted and lit (room_scene.hpp). Meters; x right, y down, z forward. Needs SCENE(index), which reads
// the scene, and push.solids and push.lamps.
const uint kSolidStride = 6u;  // of a solid, in vec4
const uint kCenter = 0u;       // xyz: center; w: kind
const uint kExtent = 1u;       // xyz: half its sides, of a ball its radius; w: kind of paint
const uint kTurn = 2u;         // cosine and sine of its turn about y; w: side of a square of the paint, meters
const uint kPaint = 3u;        // rgb: reflectance
const uint kOther = 4u;        // rgb: reflectance of the paint's second color
const uint kLamp = 5u;         // of the n-th solid: the n-th lamp. xyz: its place; w: its power, irradiance / pi at 1 m
const float kBox = 0.0, kBall = 1.0, kInside = 2.0;  // kinds; the last one is the room itself, seen from inside
const float kPlain = 0.0, kChecker = 1.0, kStripes = 2.0, kRings = 3.0, kLetters = 4.0;  // kinds of paint

struct Solid {
  vec3 center, half_size;
  float kind, paint;
  vec2 turn;
};
Solid solid_of(uint i) {
  vec4 a = SCENE(int(kSolidStride * i + kCenter)), b = SCENE(int(kSolidStride * i + kExtent)), c = SCENE(int(kSolidStride * i + kTurn));
  return Solid(a.xyz, b.xyz, a.w, b.w, c.xy);
}
vec3 into(Solid s, vec3 v) { return vec3(s.turn.x * v.x - s.turn.y * v.z, v.y, s.turn.y * v.x + s.turn.x * v.z); }
vec3 out_of(Solid s, vec3 v) { return vec3(s.turn.x * v.x + s.turn.y * v.z, v.y, s.turn.x * v.z - s.turn.y * v.x); }

// Where a ray enters a solid, or leaves the room; kFar if it does not.
const float kFar = 1e4;
float meets(Solid s, vec3 from, vec3 along) {
  vec3 o = into(s, from - s.center), d = into(s, along);
  float a = dot(d, d), b = dot(o, d), q = b * b - a * (dot(o, o) - s.half_size.x * s.half_size.x);
  vec3 low = (-s.half_size - o) / d, high = (s.half_size - o) / d;
  float enters = max(max(min(low.x, high.x), min(low.y, high.y)), min(low.z, high.z));
  float leaves = min(min(max(low.x, high.x), max(low.y, high.y)), max(low.z, high.z));
  float box = enters < leaves && enters > 0.0 ? enters : kFar, ball = q > 0.0 && b < 0.0 ? (-b - sqrt(q)) / a : kFar;
  return s.kind == kInside ? leaves : s.kind == kBox ? box : ball > 0.0 ? ball : kFar;
}

struct Hit {
  float along;
  uint solid;
};
Hit nearest(vec3 from, vec3 along) {
  Hit hit = Hit(kFar, 0u);
  for (uint i = 0u; i < push.solids; ++i) {
    float t = meets(solid_of(i), from, along);
    if (t < hit.along) hit = Hit(t, i);
  }
  return hit;
}
// Whether nothing but the room itself is met within `reach`.
float open(vec3 from, vec3 along, float reach) {
  float result = 1.0;
  for (uint i = 1u; i < push.solids; ++i) result = meets(solid_of(i), from, along) < reach ? 0.0 : result;
  return result;
}

// The face of a solid that a place on it belongs to: its axis, 0…2, and its sign. A ball has those of the box around it.
int axis_of(vec3 side) {
  vec3 size = abs(side);
  return size.x >= max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
}
// Of a place on a solid: the normal, in the solid's axes.
vec3 normal_in(Solid s, vec3 p) {
  vec3 side = p / s.half_size, face = vec3(0.0);
  int axis = axis_of(side);
  face[axis] = sign(side[axis]);
  return s.kind == kBall ? normalize(p) : s.kind == kInside ? -face : face;
}
float chance(vec2 cell) { return fract(sin(dot(cell, vec2(12.9898, 78.233))) * 43758.547); }
vec3 painted(uint i, Solid s, vec3 p, vec3 normal) {
  vec4 first = SCENE(int(kSolidStride * i + kPaint)), second = SCENE(int(kSolidStride * i + kOther));
  float side = SCENE(int(kSolidStride * i + kTurn)).w;
  vec3 n = abs(normal);
  vec2 uv = (n.x > max(n.y, n.z) ? p.zy : n.y > n.z ? p.xz : p.xy) / side;
  uv = s.kind == kBall ? vec2(atan(p.x, p.z), asin(clamp(p.y / s.half_size.x, -1.0, 1.0))) * s.half_size.x / side : uv;
  vec2 cell = floor(uv), within = uv - cell;
  bool other = false;
  if (s.paint == kChecker) other = mod(cell.x + cell.y, 2.0) > 0.5;
  if (s.paint == kStripes) other = mod(cell.x, 2.0) > 0.5;
  if (s.paint == kRings) other = mod(floor(length(uv)), 2.0) > 0.5;
  // Lines of small marks of random width, like print.
  if (s.paint == kLetters) other = abs(within.y - 0.5) < 0.25 && abs(within.x - 0.5) < 0.2 + 0.3 * chance(cell) && chance(cell + 7.0) > 0.2;
  return other ? second.rgb : first.rgb;
}

// Openness, kOpenSide² a face and six faces a solid, at places from edge to edge.
const int kOpenSide = 24;
int open_index(uint i, int axis, bool positive, ivec2 at) {
  return ((int(i) * 6 + 2 * axis + int(positive)) * kOpenSide + at.y) * kOpenSide + at.x;
}
