// SPDX-License-Identifier: LGPL-2.1-or-later
// The table of colors at binding TABLE_SLOT: cluster centers (ln c, 1) and their targets (ln b, 0) by palette
// slot, and the base colors of the layers (b, 1), kMaxColors each; zero if there is none. A storage buffer: all invocations read the same entry.
const int kMaxColors = 16;  // BaseColors::kMaxColors
layout(set = 0, binding = TABLE_SLOT, std430) readonly restrict buffer table_block { vec4 table_data[]; };

vec4 center(int k) { return LOAD(table, k); }
vec4 center_target(int k) { return LOAD(table, kMaxColors + k); }
/// Columns: the base colors of a plane's four layers, w = 1 if there is one.
mat4 base_colors(int group) {
  int k = 2 * kMaxColors + 4 * (group - 1);
  return mat4(LOAD(table, k), LOAD(table, k + 1), LOAD(table, k + 2), LOAD(table, k + 3));
}
