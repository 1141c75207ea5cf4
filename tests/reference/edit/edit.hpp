// SPDX-License-Identifier: LGPL-2.1-or-later
// The editing of layers in double precision: the specification of kernels/edit.
#pragma once
#include <array>
#include <vector>

namespace inverse::reference {

using Rgb = std::array<double, 3>;
using Rgba = std::array<double, 4>;

/// A value as read by the editors: 0 if negative or NaN, at most 65504.
double finite(double value);
Rgba finite(const Rgba& pixel);

struct RecolorSpec {
  Rgb key{}, target{};
  double tolerance = 0, value_tolerance = 0, softness = 0;  ///< value_tolerance ≥ 20: no limit
  double texture = 1, strength = 1;
  double brightness = 0, hue_shift = 0;  ///< degrees
  bool own_color = false;
};

/// Selection of a pixel (R.rgb, S) by the key, 0…1.
double selection(const Rgba& layers, const RecolorSpec& spec);

/// The same for the pixels nearest to a cluster: `own` is the ln of its color, `others` those of
/// the rest.
double selection(const Rgba& layers, const Rgb& own, const std::vector<Rgb>& others,
                 double softness);

/// (R', S) of a pixel (R, S) with this selection. `mask`: its matte, and the reflectance of what is
/// behind it minus R.
Rgba recolor(const Rgba& layers, double selection, double key_value, const RecolorSpec& spec,
             const Rgba& mask = {1, 0, 0, 0});

/// The edited pixel, selected by the key.
Rgba recolor(const Rgba& layers, const Rgba& mask, const RecolorSpec& spec);
/// The same without a mask.
inline Rgba recolor(const Rgba& layers, const RecolorSpec& spec) {
  return recolor(layers, {1, 0, 0, 0}, spec);
}

enum class Residual { add, ratio, none };
Rgba compose(const Rgba& input, const Rgba& model, const Rgba& intrinsic, Residual residual,
             double strength);
Rgba difference(const Rgba& input, const Rgba& model, const Rgba& intrinsic);

/// A frame of diffuse light and highlights, edited or not; and what the edit changed.
Rgba recombine(const Rgba& input, const Rgba& diffuse, const Rgba& specular, double strength);
Rgba recombine_difference(const Rgba& input, const Rgba& diffuse, const Rgba& specular);

}  // namespace inverse::reference
