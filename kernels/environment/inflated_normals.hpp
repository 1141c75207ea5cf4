#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace inverse {

/// A unit normal in the camera's directions: x right, y up, z to the camera. z = 0: none.
using Normal = std::array<float, 3>;

/// Part of a grid of points: columns left…right − 1, rows top…bottom − 1.
struct GridWindow {
  uint32_t left = 0, top = 0, right = 0, bottom = 0;
};

/// Normals of an object of which only the outline is known: it is taken for a body that is inflated
/// from it. With ∇²u = −4 inside and u = 0 along the outline, its height is √u: exact for a sphere.
/// An ellipse with half axes a and b becomes an ellipsoid with the third √(2 a²b² / (a² + b²)); a
/// long cylinder √2 times too deep; dents, edges and flat faces are not seen at all.
///
/// `mask` has a byte a point, row by row, `side` x `side`, not 0 where the object is; of points
/// outside of `window` nothing is known, so that the body goes on there. A normal for each point,
/// none outside of the mask.
std::vector<Normal> inflated_normals(std::span<const uint8_t> mask, uint32_t side,
                                     const GridWindow& window);

}  // namespace inverse
