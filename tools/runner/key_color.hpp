// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <optional>
#include <vector>

namespace inverse::run {

/// A small picture in linear light: R, G, B of each pixel, row by row.
struct LinearPicture {
  int width = 0, height = 0;
  std::vector<float> rgb;
};

/// A color to repaint: what intrinsicrecolor's key, tolerance and softness select.
struct KeyColor {
  std::array<double, 3> chromaticity;  ///< R / mean R
  double tolerance, softness;          ///< distances of chromaticity
  double share;                        ///< of the pixels, averaged over the pictures
};

/// The color of a video that is best repainted: saturated, of fair size, distinct from the rest
/// of the picture, on connected things rather than on scattered pixels, and there in most of the
/// pictures. The pictures are of some moments of one video, some hundred pixels wide, all of one
/// size. Nothing where no color is like that. Decomposed under white light, reflectance has the
/// frame's chromaticity, so it need not be known here.
std::optional<KeyColor> find_key_color(const std::vector<LinearPicture>& pictures);

}  // namespace inverse::run
