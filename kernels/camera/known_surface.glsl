// SPDX-License-Identifier: LGPL-2.1-or-later
// A pixel of SeenScene::surface, all 0 where it has no normal or no depth. Needs image/finite.glsl.
vec4 known_surface(vec4 seen) {
  float depth = finite(seen).w, square = finite(vec4(dot(seen.xyz, seen.xyz))).x;
  return depth > 0.0 && depth < kLargest && square > 0.5 && square < 2.0 ? vec4(seen.xyz, depth) : vec4(0.0);
}
