// SPDX-License-Identifier: LGPL-2.1-or-later
// Drawn frames in double precision: the specification of kernels/edit/stylize.
#pragma once
#include <cstddef>
#include <vector>

#include "edit.hpp"

namespace inverse::reference {

/// A picture of one number a pixel.
struct Field {
  unsigned width = 0, height = 0;
  std::vector<double> values;
  double& at(unsigned x, unsigned y) { return values[std::size_t{y} * width + x]; }
  /// At the border, the picture goes on.
  double at_or_border(long x, long y) const;
};

struct LayersField {
  unsigned width = 0, height = 0;
  std::vector<Rgba> pixels;
};

/// Log shading in stops, 0 in the dark.
double encoded_shading(double s);
double decoded_shading(double e);
Field encoded_shading(const LayersField& layers);

/// The picture blurred by a Gaussian, as the kernels do it: means of cells, a Gaussian on them, and
/// linear interpolation. `ratio` × sigma is the width; cells follow from sigma alone.
Field blurred(const Field& field, double sigma, double ratio);
/// The same by definition: a Gaussian of so many pixels.
Field gaussian(const Field& field, double sigma);

struct StylizeSpec {
  double scale = 2, sensitivity = 0, sharpness = 1, levels = 0, softness = 0.4, flatten = 0,
         strength = 1;
};

/// Shading of a pixel from the two blurred pictures.
double drawn_shading(double s, double near, double wide, const StylizeSpec& spec);

/// The bilateral filter, along rows and then along columns.
LayersField flattened(const LayersField& layers, double sigma, double difference);

/// The edited frame; `matte` has a value for each pixel, or none.
LayersField stylize(const LayersField& layers, const std::vector<double>& matte,
                    const StylizeSpec& spec);

}  // namespace inverse::reference
