// SPDX-License-Identifier: LGPL-2.1-or-later
// Colors of globalintrinsic's model: light on a pixel is white direct light T0 and colored indirect
// light E, and its tint t is the log chroma of their sum. Plain C++ in double precision.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tests/reference/plane.hpp"

namespace inverse::reference::global {

/// Log chroma: coordinates of ln RGB along (1, -1, 0) / √2 and (1, 1, -2) / √6; gray is 0.
struct Chroma : std::array<double, 2> {};

inline constexpr double kChromaFloor = 3e-3;  ///< Added before logarithms: black becomes neutral.

double mean(const Vec3& color);
double norm2(const Chroma& c);
Chroma operator+(const Chroma& a, const Chroma& b);
Chroma operator-(const Chroma& a, const Chroma& b);
Chroma operator*(double f, const Chroma& c);

/// Log chroma of a linear color.
Chroma chroma_of(const Vec3& color);

/// exp(Aᵀ c): the color of log chroma c whose geometric mean is 1.
Vec3 color_of(const Chroma& c);

/// Light of mean `shading` (>= 0) split into white direct light and an indirect part, at most all.
struct Split {
  double direct = 0;
  Vec3 indirect{};
  double fraction = 0;  ///< Mean of indirect over shading, 0 ... 1.
};
Split split(double shading, const Vec3& indirect);

/// Light exp(s) tau in two layers: the gathered indirect light, and more of it if white direct
/// light cannot explain the color.
struct PixelLight {
  double direct = 0;
  Vec3 indirect{};
};
PixelLight compose(double exp_s, const Vec3& tau, const Vec3& gathered);

/// Log chroma of split(shading, indirect).
Chroma tint_of(double shading, const Vec3& indirect);

/// Box means of a frame on a grid, the input of all later steps.
struct Grid {
  int width = 0, height = 0;
  int factor = 1;               ///< Pixels along the side of one of its points.
  std::vector<Vec3> color;      ///< Mean I.
  std::vector<double> shading;  ///< Mean of exp(s_guess).
  std::vector<Chroma> chroma;   ///< Of the mean I.
  std::vector<double> weight;   ///< Mean I if its color is reliable, else 0.
  std::size_t size() const { return color.size(); }
};

/// The power of two that makes a grid at most `most` wide and high of a frame.
int grid_factor(int width, int height, int most);

/// Box means over factor x factor pixels (fewer at the right and lower border) of sanitized
/// interleaved linear RGB and of `shading`. A mean below 0.01 or a channel above 0.98 has weight 0.
Grid make_grid(const std::vector<double>& rgb, const std::vector<double>& shading, int width,
               int height, int factor);

/// Log chroma of the light by "shades of gray": the sixth-power mean of the grid's colors
/// (Finlayson and Trezzi 2004); 0 if none can be trusted.
Chroma illuminant(const Grid& grid);

/// Bilinear position of the center of fine point x in a grid whose points are `factor` fine ones
/// wide: lower index, upper index, share of the upper.
struct Between {
  std::size_t low, high;
  double share;
};
Between between(int x, int factor, int count);

}  // namespace inverse::reference::global
