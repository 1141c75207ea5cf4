// SPDX-License-Identifier: LGPL-2.1-or-later
// A picture on a plane of the reflectance in double precision: the specification of
// kernels/texture.
#pragma once
#include <cstddef>
#include <vector>

#include "tests/reference/edit/edit.hpp"

namespace inverse::reference {

/// Pixels row by row.
template <typename T>
struct Grid {
  size_t width = 0, height = 0;
  std::vector<T> data;
  const T& at(size_t x, size_t y) const { return data[y * width + x]; }
};
using Matrix = std::array<std::array<double, 3>, 3>;

/// Y^(1/2.2) of the mean linear light of factor × factor pixels.
Grid<double> luminance(const Grid<Rgba>& frame, size_t factor);

/// A picture and its levels, down to 1 × 1; colors are multiplied by alpha.
std::vector<Grid<Rgba>> texture_levels(const Grid<Rgba>& picture);

/// What is learned of a cell of a plane: mean of ln (R + .02), frames, mean spread.
struct Cell {
  Rgb mean{};
  double frames = 0, spread = 0;
};
/// What is seen of a cell now; a spread < 0: it is not in the frame.
struct Observed {
  Rgb mean{};
  double spread = -1;
};
/// The cell at (x, y) of `cells` (columns, rows); `to_frame` maps the unit square to pixels.
Observed observe(const Grid<Rgba>& model, const Matrix& to_frame, size_t x, size_t y,
                 std::array<size_t, 2> cells);
/// By how much a cell differs from what is learned, beyond twice its spread.
double excess(const Observed& now, const Cell& learned);
/// 0…1: what stands before each cell.
Grid<double> hide(const Grid<double>& excess, double tolerance, double softness);
void learn(Cell& learned, const Observed& now, double hidden);
Grid<double> soften(const Grid<double>& hidden);

struct TextureSpec {
  Matrix to_plane{};  ///< from pixels to the unit square
  double white = 0.9, opacity = 1;
};
/// (R', S) of the pixel (x, y) with this matte; `hidden` may be null.
Rgba draw_texture(const Rgba& layers, size_t x, size_t y, double matte,
                  const std::vector<Grid<Rgba>>& levels, const Grid<double>* hidden,
                  const TextureSpec& spec);
/// By how much the ratio of the sides of a pixel on the picture is off a whole number, where the
/// number of samples changes.
double off_whole_taps(size_t x, size_t y, const Grid<Rgba>& picture, const TextureSpec& spec);

}  // namespace inverse::reference
