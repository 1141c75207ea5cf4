// SPDX-License-Identifier: LGPL-2.1-or-later
// A foreground before a screen of one paint. Double precision. Light and reflectance count as at
// most 16.
//
// Excess of a color c of chroma q = c - mean c toward a direction d of length 1:
//
//   e(c, d) = q.d - |q - (q.d) d| / sqrt(3)
//
// For d of green it is sqrt(2/3) (G - max(R, B)). If d is the direction of a color B, e is linear
// in mixtures with B: e(a F + (1 - a) B) = a e(F) + (1 - a) e(B).
//
// The screen's reflectance K is a mean of a sample of the frame, weighted by the excess toward the
// key's hue, then, three times, also by nearness of chromaticity R / mean R to the mean before.
// Pixels whose chromaticity is within the tolerance of K's, and whose brightness is near, surely
// show the screen. The screen's light B is the mean of theirs on cells; what cells leave open is
// filled in from coarser cells. Where 1 - e(I, d) / |chroma B| is near 1, light is the
// foreground's: F, spread in the same way. In units of |chroma B| along d of B, let i and f be
// chroma of I and of F, and I', F' what is across. F's part of the light is u = I'.F' / F'.F', if F
// has chroma across:
//
//   mixed = (1 - k) (1 - i) / (1 - min(f, 0)) + k (1 - i + u f),   k = F'.F' / (F'.F' + 0.15^2)
//   solid = (1 - e(I, d)) / (1 - e(F, d))
//
// Alpha is `solid` where all around is the foreground's, `mixed` elsewhere,
// stretched from black ... white to 0 ... 1. The picture's light is
//
//   (I - (1 - alpha) B + k F) / (alpha + k),   k = 0.05 (1 - alpha)
//
// less its excess times `despill` toward d.
#pragma once

#include "tests/reference/plane.hpp"

namespace inverse::reference {

struct KeySpec {
  Vec3 key{0.0144, 0.527, 0.0513};
  bool of_border = false;
  double tolerance = 0.25, black = 0.05, white = 0.95, despill = 1, shrink = 0, strength = 1;
  bool invert = false;
};

/// K; w is 1, or 0 if there is no screen.
Vec4 screen_of(const Plane& intrinsic, const KeySpec& spec);

/// Light of the screen and of the foreground on cells of side x side pixels; w: 1, or 0 if there is
/// none; between: how surely a cell is within what is of its kind.
struct KeyLight {
  Plane behind, front;
};
KeyLight key_light(const Plane& frame, const Plane& intrinsic, const Vec4& screen, int side,
                   double tolerance);

/// x: the matte before it is shrunk; yzw: reflectance of what is behind minus the pixel's. `mask`
/// may be null.
Plane key_matte(const Plane& frame, const Plane& intrinsic, const KeyLight& light, int side,
                const Plane* mask, const KeySpec& spec);
/// The smallest x within `radius` pixels; the largest if that is negative.
Plane shrunk(const Plane& matte, double radius);
/// Light and alpha. `composed`: the frame with its edits, or null.
Plane keyed_picture(const Plane& frame, const Plane* composed, const KeyLight& light, int side,
                    const Plane& matte, const Plane& shrunk, const KeySpec& spec, bool over_black);

}  // namespace inverse::reference
