// What lies between the networks of limematerial (thesis chapter 6), in double precision: the
// square that they look at, what each hands to the next, and the layers of the frame.
#pragma once

#include <cstdint>

#include "tests/reference/plane.hpp"

namespace inverse::reference {

/// side × side points of a square of the frame, which may reach over its borders.
struct LimeSquare {
  double x = 0, y = 0;  ///< top left corner, pixels
  double pixels = 1;    ///< of the frame along a point
  int side = 0;
};

/// sRGB of the mean light on each point: of 12 × 12 places in it at most.
Plane lime_crop(const Plane& frame, const LimeSquare& square);

/// Probabilities without points that are foreign: of no object, or of another.
Plane lime_drop_foreign(const Plane& probability, const std::vector<uint32_t>& foreign);

/// SpecularNet's input: the picture where the object is, w = mask.
Plane lime_to_specular(const Plane& image, const Plane& probability);

/// What SpecularNet gave (x; what is no number, or below 0, is 0), where the object is: MirrorNet's
/// input in x, and AlbedoNet's, the picture and the code in w.
struct LimeSpecular {
  Plane mirror_in, albedo_in;
};
LimeSpecular lime_to_mirror_and_albedo(const Plane& masked, const Plane& specular);

/// ExponentNet's input: the code that MirrorNet saw (x), and in y what MirrorNet gave (x, as
/// above), where the object is.
Plane lime_to_exponent(const Plane& masked, const Plane& specular, const Plane& mirror);

/// A frame with a sphere before it, at (x, y) pixels. `table`: how the sphere looks by its normal
/// (lit_lookup).
Plane lime_preview(const Plane& frame, const Plane& table, double x, double y, double radius);

/// Linear light of codes ln(1 + 4 x) / 2.
double lime_decode(double code);

/// The diffuse light of the object at every point, in linear RGB: the picture without the specular
/// layer where the camera tells it, else filled in from there by a pyramid of means. `codes`: that
/// of the specular layer in x.
Plane lime_under_highlights(const Plane& masked, const Plane& codes);

/// The specular layer around every point as a line of the picture's least channel: slope (x) and
/// offset (y), means of the lines of 5 × 5 points that a guided filter finds. `codes`: as above.
Plane lime_guided_specular(const Plane& masked, const Plane& codes);

/// The probability (x) around every point as a plane of the roots of linear RGB, slopes and offset
/// (w), likewise. Points of probability 0 do not count and have zeros.
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
