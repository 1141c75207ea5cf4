// SPDX-License-Identifier: LGPL-2.1-or-later
// Surfaces as closed grids of vertices: rows along a meridian or a curve, columns around it.
#pragma once

#include <functional>
#include <vector>

#include "vec.hpp"

namespace inverse::lime {

/// rows × columns vertices. Columns wrap around; rows wrap where `wrap_rows`, and otherwise start
/// and end at a point. Seen from outside, (row, column), (row, column + 1), (row + 1, column) run
/// counter-clockwise or not as `finish` left it: after `finish` the winding is outward.
struct Grid {
  int rows = 0, columns = 0;
  bool wrap_rows = false;
  std::vector<Vec> positions, normals;

  /// Vertex index; row and column may exceed the grid by one where it wraps.
  int at(int row, int column) const {
    return (row == rows ? 0 : row) * columns + (column == columns ? 0 : column);
  }
  /// Rows of cells.
  int cells() const { return wrap_rows ? rows : rows - 1; }
};

/// The grid of `position(u, v)`: u in [0, 1] over rows (without 1 if they wrap), v in [0, 1)
/// over columns; finished.
Grid make_grid(int rows, int columns, bool wrap_rows,
               const std::function<Vec(float u, float v)>& position);

/// Turns the winding outward (positive enclosed volume) and computes normals, area-weighted over
/// the cells around.
void finish(Grid& grid);

/// Calls visit(i, j, k) for the vertex indices of every triangle.
template <typename Visit>
void each_triangle(const Grid& grid, Visit visit) {
  for (int row = 0; row < grid.cells(); ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const int a = grid.at(row, column), b = grid.at(row, column + 1);
      const int c = grid.at(row + 1, column + 1), d = grid.at(row + 1, column);
      visit(a, b, c);
      visit(a, c, d);
    }
}

}  // namespace inverse::lime
