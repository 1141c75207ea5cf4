#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace inverse {

/// Triangles with a normal at every corner. Axes are those of the camera: x right, y up, z towards
/// the camera.
struct Mesh {
  using Vec3 = std::array<float, 3>;
  static constexpr size_t kMaxTriangles = 1000000;

  std::vector<Vec3> positions, normals;  ///< as many of each
  std::vector<uint32_t> indices;         ///< three a triangle

  size_t triangles() const { return indices.size() / 3; }

  /// Makes it fit to be drawn: drops triangles without area, with corners that do not exist or are
  /// not finite; gives corners without a normal (absent, zero, not finite) the mean of those of
  /// their triangles, by area; moves and scales it so that the smallest box around it has its
  /// center at the origin and the farthest corner lies at distance 1; sorts triangles so that those
  /// near each other in space are near each other in the list. Throws Error(file) where nothing
  /// remains and where there are more than kMaxTriangles; `name` is what the text calls it.
  void prepare(const char* name);

  /// A sphere of radius 1, prepared.
  static Mesh sphere();
};

}  // namespace inverse
