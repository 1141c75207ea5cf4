// SPDX-License-Identifier: LGPL-2.1-or-later
// Indirect light as one scalar layer per base color, E = sum over k of b_k T_k plus a remainder,
// for editors: recoloring a base color recolors its indirect light.
#pragma once

#include "global_intrinsic.hpp"

namespace inverse::reference {

struct IndirectLayers {
  std::vector<Vec3> base;                   ///< b_k per slot, largest channel 1; 0: unused.
  std::vector<std::vector<double>> amount;  ///< T_k >= 0 per slot and pixel.
  std::vector<double> remainder;            ///< 3 interleaved channels, of any sign.
};

/// Splits the indirect layer of a frame. T_k starts as the light from surfaces of base color k,
/// projected onto b_k, and takes `steps` multiplicative steps of non-negative least squares (Lee
/// and Seung 2001), T_k <- T_k (b_k . E) / (b_k . sum over l of b_l T_l). The emitters are labeled
/// with the base colors of the frame before. On a first frame and after a cut all light belongs to
/// slot 0, so a still is decomposed twice.
IndirectLayers split_indirect(const GlobalResult& frame, int width, int height, int steps = 3);

/// Reflectance and indirect light after base color k becomes `color` (linear, any scale): pixels of
/// the label change by the ratio of the colors, and the light of that layer with them.
struct Recolored {
  std::vector<double> reflectance, indirect;
};
Recolored recolor(const GlobalResult& frame, const IndirectLayers& layers, std::size_t k,
                  const Vec3& color);

}  // namespace inverse::reference
