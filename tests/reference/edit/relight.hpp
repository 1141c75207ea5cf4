// SPDX-License-Identifier: LGPL-2.1-or-later
// Lamps in double precision: the specification of kernels/edit/relight.
#pragma once
#include <optional>
#include <vector>

#include "edit.hpp"

namespace inverse::reference {

/// A lamp of a scene: x right, y down, z to the viewer.
struct SceneLamp {
  enum class Kind { point, spot, directional };
  Kind kind = Kind::point;
  Rgb place{}, axis{0, 0, -1};  ///< axis: of length 1
  Rgb light{};                  ///< shading that it adds at a distance of 1
  double angle = 0.5;           ///< of a spot, radians: axis to edge
  double softness = 0.3;        ///< share of it in which light falls
  double radius = 0;
};

/// Where light falls: a place and a normal of length 1.
struct Surface {
  Rgb place{}, normal{0, 0, 1};
};

/// Σ of the lamps' light on a surface: power · max(n·l, 0) / max(d², radius²), within a cone.
Rgb light_on(const Surface& surface, const std::vector<SceneLamp>& lamps);

/// What a frame has of light: L and the direct share of S; slope and shading of white light.
struct LightLayers {
  std::optional<Rgba> light;
  std::optional<std::array<double, 2>> slope;
};
struct Relit {
  Rgba intrinsic, light;
  double kept = 1;  ///< share of S' that was in S
};
/// Adds light to a share `keep` of what a pixel (R.rgb, S) has.
Relit relight(const Rgba& intrinsic, const LightLayers& before, double keep, const Rgb& added);

/// Slopes dh/dx, dh/dy of the relief of log shading `u`, a grid of width × height, row by row,
/// before they are bounded: Σ over the levels of a pyramid of the differences of neighbors there.
std::vector<std::array<double, 2>> relief_slopes(std::vector<double> u, unsigned width,
                                                 unsigned height, unsigned min_cells);
/// g / √(1 + |g|²).
void bound_slopes(std::vector<std::array<double, 2>>& slopes);
/// ln S of cells of factor × factor pixels, row by row.
std::vector<double> log_cells(const std::vector<Rgba>& layers, unsigned width, unsigned height,
                              unsigned factor);
/// A cell after a further frame.
double follow_cell(double before, double now);

/// A value of a grid of slopes at a pixel.
std::array<double, 2> slope_at(const std::vector<std::array<double, 2>>& slopes, unsigned width,
                               unsigned height, double x, double y);

}  // namespace inverse::reference
