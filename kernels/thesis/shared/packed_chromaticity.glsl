// SPDX-License-Identifier: LGPL-2.1-or-later
/// A pixel's chromaticity as sample frames carry it: red and blue on a grid of 3/4095, red · 4096 + blue, exact in a
/// float; green follows, the mean being 1.
float pack_chromaticity(vec3 c) { return floor(c.r * 1365.0 + 0.5) * 4096.0 + floor(c.b * 1365.0 + 0.5); }
