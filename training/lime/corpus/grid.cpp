// SPDX-License-Identifier: LGPL-2.1-or-later
#include "grid.hpp"

#include <algorithm>

namespace inverse::lime {
namespace {

/// Gives all vertices of a row that is one point (a pole) the same normal.
void share_normal(Grid& grid, int row) {
  const auto first = std::size_t(row) * std::size_t(grid.columns);
  const auto count = std::size_t(grid.columns);
  Vec sum;
  for (std::size_t i = first; i < first + count; ++i) {
    if (length(grid.positions[i] - grid.positions[first]) > 1e-5f) return;
    sum += grid.normals[i];
  }
  for (std::size_t i = first; i < first + count; ++i) grid.normals[i] = sum;
}

}  // namespace

Grid make_grid(int rows, int columns, bool wrap_rows,
               const std::function<Vec(float u, float v)>& position) {
  Grid grid{rows, columns, wrap_rows, {}, {}};
  grid.positions.reserve(std::size_t(rows * columns));
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      grid.positions.push_back(position(float(row) / float(wrap_rows ? rows : rows - 1),
                                        float(column) / float(columns)));
  finish(grid);
  return grid;
}

void finish(Grid& grid) {
  const auto& p = grid.positions;
  double volume = 0;
  each_triangle(grid, [&](int i, int j, int k) {
    volume += double(dot(p[std::size_t(i)], cross(p[std::size_t(j)], p[std::size_t(k)])));
  });
  if (volume < 0)
    for (int row = 0; row < grid.rows; ++row) {
      const auto first = grid.positions.begin() + row * grid.columns;
      std::reverse(first, first + grid.columns);
    }
  grid.normals.assign(p.size(), {});
  each_triangle(grid, [&](int i, int j, int k) {
    const Vec a = p[std::size_t(i)], b = p[std::size_t(j)], c = p[std::size_t(k)];
    const Vec n = cross(b - a, c - a);
    for (const int v : {i, j, k}) grid.normals[std::size_t(v)] += n;
  });
  if (!grid.wrap_rows) {
    share_normal(grid, 0);
    share_normal(grid, grid.rows - 1);
  }
  for (Vec& n : grid.normals) n = normalize(n);
}

}  // namespace inverse::lime
