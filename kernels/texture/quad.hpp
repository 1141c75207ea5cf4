// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <string>

namespace inverse {

using Point = std::array<double, 2>;  ///< in pixels; pixel (x, y) covers [x, x + 1) × [y, y + 1)
/// Top left, top right, bottom right, bottom left, as a picture's corners lie on a plane.
using Corners = std::array<Point, 4>;
/// A homography, row by row.
using Homography = std::array<double, 9>;

/// What is wrong with four corners, in words: not finite or beyond ±kFarthest, of less than
/// kMinArea, concave, crossed. Empty if nothing is. They may be in either sense of rotation.
std::string wrong_corners(const Corners& corners);
constexpr double kFarthest = 1e5;
constexpr double kMinArea = 16;

/// Area in square pixels, negative if the corners go counterclockwise as seen.
double area_of(const Corners& corners);

/// From the unit square, (0, 0) at the top left, to corners with which nothing is wrong. Its third
/// coordinate is positive in the square.
Homography square_to(const Corners& corners);
/// From the corners to the unit square; its third coordinate is positive on the side of the horizon
/// where the corners are.
Homography to_square(const Corners& corners);

/// A homography is applied to a point.
Point mapped(const Homography& h, Point p);

}  // namespace inverse
