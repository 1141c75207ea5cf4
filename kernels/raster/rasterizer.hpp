#pragma once
#include <array>
#include <memory>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/raster_bin.spv.hpp"
#include "kernels/raster_depth.spv.hpp"
#include "kernels/raster_draw.spv.hpp"
#include "kernels/raster_edges.spv.hpp"
#include "kernels/raster_place.spv.hpp"
#include "mesh.hpp"

namespace inverse {

/// How a mesh lies in a picture, seen by a camera that is far away (no perspective).
struct MeshView {
  using Row = std::array<float, 3>;
  std::array<Row, 3> turn{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< rows of a rotation
  float scale = 1;                                             ///< pixels a unit
  float x = 0, y = 0;  ///< where the mesh's origin is, in pixels; pixel centers are at a half
  bool operator==(const MeshView&) const = default;
};

/// Draws meshes by compute. Corners are placed; the edge functions of triangles are made, in groups
/// of a few that are neighbors in space; each tile notes in bits which groups may show in it; each
/// pixel finds the nearest triangle at eight points. No atomics and no lists: what comes out is the
/// same on every run, and memory depends on the mesh and the picture's size alone. Edges are
/// inclusive, so that closed meshes have no cracks.
class Rasterizer {
 public:
  /// `mesh` is prepared (Mesh::prepare).
  Rasterizer(const std::shared_ptr<gpu::Device>& device, const Mesh& mesh);

  /// Draws it by the table of a lit sphere, into linear RGB times coverage, w = coverage.
  void draw(gpu::Commands& commands, const MeshView& view, const Plane& table,
            const Plane& picture);
  /// x = mean depth (pixels towards the camera, from the mesh's origin) where it covers a pixel,
  /// y = the share that it covers.
  void depth(gpu::Commands& commands, const MeshView& view, const Plane& picture);

 private:
  using Grid = shaders::raster_draw::Push;  // of draw_ and depth_
  Grid prepare(gpu::Commands& commands, const MeshView& view, Extent extent);

  gpu::Program<shaders::raster_place> place_;
  gpu::Program<shaders::raster_edges> edges_;
  gpu::Program<shaders::raster_bin> bin_;
  gpu::Program<shaders::raster_draw> draw_;
  gpu::Program<shaders::raster_depth> depth_;
  uint32_t corner_count_, triangles_, group_, groups_;
  gpu::BufferPtr corners_, indices_, placed_, records_, boxes_, bounds_, bits_;
};

}  // namespace inverse
