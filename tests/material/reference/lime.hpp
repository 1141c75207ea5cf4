// SPDX-License-Identifier: LGPL-2.1-or-later
// The steps between the networks of limematerial (thesis chapter 6), in double precision: the
// analyzed square, inputs of each network, and the layers of the frame.
#pragma once

#include <cstdint>

#include "tests/reference/plane.hpp"

namespace inverse::reference {

/// side × side points of a square of the frame, which may extend beyond it.
struct LimeSquare {
  double x = 0, y = 0;  ///< top left corner, pixels
  double pixels = 1;    ///< of the frame along a point
  int side = 0;
};

/// sRGB of the mean light of each point, from at most 12 × 12 samples.
Plane lime_crop(const Plane& frame, const LimeSquare& square);

/// Probabilities without masked-out points: of no object, or of another one.
Plane lime_drop_foreign(const Plane& probability, const std::vector<uint32_t>& foreign);

/// SpecularNet's input: the image on the object, w = mask.
Plane lime_to_specular(const Plane& image, const Plane& probability);

/// SpecularNet's output on the object (x; NaN or negative values become 0): MirrorNet's input in x,
/// and AlbedoNet's input, the image and the code in w.
struct LimeSpecular {
  Plane mirror_in, albedo_in;
};
LimeSpecular lime_to_mirror_and_albedo(const Plane& masked, const Plane& specular);

/// ExponentNet's input on the object: the code of the specular layer (x), and MirrorNet's output in
/// y (x, as above).
Plane lime_to_exponent(const Plane& masked, const Plane& specular, const Plane& mirror);

/// A frame with a sphere in front of it, at (x, y) pixels. `table`: shading of the sphere by normal
/// (lit_lookup).
Plane lime_preview(const Plane& frame, const Plane& table, double x, double y, double radius);

/// Linear light of codes ln(1 + 4 x) / 2.
double lime_decode(double code);

/// The diffuse light of the object at every point, linear RGB: the image minus the specular layer
/// at valid points, else interpolated from these by a pyramid of means. `codes`: of the specular
/// layer in x.
Plane lime_under_highlights(const Plane& masked, const Plane& codes);

/// The specular layer around every point as a linear function of the image's smallest channel:
/// slope (x) and offset (y), means of the guided filter's lines over 5 × 5 points. `codes`: as
/// above.
Plane lime_guided_specular(const Plane& masked, const Plane& codes);

/// The probability (x) around every point as a linear function of sqrt(linear RGB), slopes and
/// offset (w), likewise. Points of probability 0 are ignored and get zeros.
Plane lime_guided_mask(const Plane& image, const Plane& probability);

struct LimeLayers {
  Plane diffuse;  ///< linear RGB without the specular layer, w = mask
  Plane gloss;    ///< specular layer in rgb, w = mirror image
};
/// Mask and specular layer as lines (above), `codes` of the mirror image (y), and the light under
/// highlights, at the points.
LimeLayers lime_layers(const Plane& frame, const LimeSquare& square, const Plane& mask_lines,
                       const Plane& codes, const Plane& specular_lines, const Plane& under);

}  // namespace inverse::reference
