// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/edit/selection/grid.hpp"
#include "kernels/image/place.hpp"

namespace inverse {

/// What a user draws to select an object: a click, a line over it, or a line around it. In pixels
/// of a frame, the first one's center at .5.
struct SelectionStroke {
  using Point = Place;
  bool subtract = false;      ///< it belongs to something else
  bool closed = false;        ///< what is inside of the line, and not what borders on it
  std::vector<Point> points;  ///< may be outside of the frame
  float radius = 6;           ///< of the round brush, > 0; not of a closed stroke
  bool operator==(const SelectionStroke&) const = default;
};

/// Cells that a stroke covers, and those of them that later strokes of the other kind take from it:
/// of strokes of one kind, from the first.
struct SeedCells {
  uint32_t covered = 0, taken = 0;
};

/// Of every cell, row by row: 0, or the constant kSeedAdd or kSeedSubtract of object.glsl if its
/// center is at most the radius and half a cell away from a stroke, or inside of a closed one
/// (even-odd) or half a cell away from it. The last stroke counts. kSeedAround: up to two cells
/// farther away from a closed one that adds. `drawn` is the size of the frame that they were drawn
/// on. `cells`: set to those of every stroke, if it is not null.
std::vector<uint32_t> draw_seeds(std::span<const SelectionStroke> strokes, Extent drawn,
                                 const CellGrid& grid, std::vector<SeedCells>* cells = nullptr);

}  // namespace inverse
