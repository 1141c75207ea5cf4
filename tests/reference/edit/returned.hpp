// SPDX-License-Identifier: LGPL-2.1-or-later
// What effects changed in pictures of layers, in double precision: the specification of
// kernels/edit/returned.
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "edit.hpp"
#include "tests/reference/image/light_color.hpp"

namespace inverse::reference {

/// A picture of a layer as it was sent (q) and as it came back (p), linear, width x height.
struct ReturnedPicture {
  std::vector<Rgba> sent, returned;
  size_t width = 0, height = 0;
  double gain = 1;  ///< q is min(gain · layer, 1), in few bits
  std::array<double, 9> gamut{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< to the primaries of the layers
};

/// v' − v of a channel: v p / q if p < q, v + (p − q) / gain if p > q.
double change(double v, double p, double q, double gain);

/// The same of a color at (x, y) of layers of this size: the bilinear mean over a picture of
/// another size.
Rgb change_at(const Rgb& v, const ReturnedPicture& picture, size_t x, size_t y, size_t width,
              size_t height);

/// (R', S) and mask' of a pixel.
Rgba edited_reflectance(const Rgba& layers, const Rgb& change, double weight);
Rgba edited_mask(const Rgba& mask, const Rgb& change, double weight);

/// Light S C L of a pixel.
struct Light {
  double shading = 0;
  Rgba color{1, 1, 1, 1};         ///< L, and the direct share
  Rgb lamp{1, 1, 1};              ///< color of direct light
  std::optional<LightColor> own;  ///< C by shading; white if there is none

  Rgb unit() const;      ///< S C
  Rgb total() const;     ///< S C L
  Rgb direct() const;    ///< its direct part
  Rgb indirect() const;  ///< the rest
};

enum class LightPart { all, direct, indirect };
/// The light after its part changed by `weight` · `change`: of `all` brightness goes to S, else to
/// L. Without `tint`, L stays.
Light edited_light(const Light& light, LightPart part, const Rgb& change, double weight, bool tint);

}  // namespace inverse::reference
