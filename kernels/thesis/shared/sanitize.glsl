// SPDX-License-Identifier: LGPL-2.1-or-later
float finite(float v) { return v > 0.0 ? (v <= 3.4028234e38 ? min(v, 65504.0) : 1.0) : 0.0; }

/// The input of the solvers: NaN and -Inf become 0, +Inf 1, the rest is clamped to 0...65504.
vec3 sanitized(vec4 v) { return vec3(finite(v.r), finite(v.g), finite(v.b)); }
