// SPDX-License-Identifier: LGPL-2.1-or-later
// What is known of a level's reflectance (4.8). The includer defines KNOWN_BINDING, of an input that is not read if w_known is 0.
PLANE_IN(KNOWN_BINDING, known_targets);  // (B r_model, B); coarser levels have means of the finest one's

vec4 known_at(int n) { return push.w_known > 0.0 ? FETCH(known_targets, n) : vec4(0.0); }
