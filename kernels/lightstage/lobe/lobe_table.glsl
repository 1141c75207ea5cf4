// SPDX-License-Identifier: LGPL-2.1-or-later
// Lookup in a table over u and p (light_table.comp), bound by the kernel with the name lobe_values.
vec4 lobe_table(vec3 u, float p) {
  float level = clamp(2.0 * log2(p + 1.0), 0.0, float(kLevels - 1));
  int l = min(int(level), kLevels - 2);
  vec2 at = (unfolded(u) * 0.5 + 0.5) * float(kSide - 1);
  ivec2 cell = clamp(ivec2(at), ivec2(0), ivec2(kSide - 2));
  vec2 f = at - vec2(cell);
  int i = (l * kSide + cell.y) * kSide + cell.x, j = i + kSide * kSide;
  vec4 lower = mix(mix(FETCH(lobe_values, i), FETCH(lobe_values, i + 1), f.x),
                   mix(FETCH(lobe_values, i + kSide), FETCH(lobe_values, i + kSide + 1), f.x), f.y);
  vec4 upper = mix(mix(FETCH(lobe_values, j), FETCH(lobe_values, j + 1), f.x),
                   mix(FETCH(lobe_values, j + kSide), FETCH(lobe_values, j + kSide + 1), f.x), f.y);
  return mix(lower, upper, level - float(l));
}
