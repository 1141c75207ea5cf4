// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/material_raster_bin.spv.hpp"
#include "kernels/material_raster_depth.spv.hpp"
#include "kernels/material_raster_draw.spv.hpp"
#include "kernels/material_raster_draw_room.spv.hpp"
#include "kernels/material_raster_edges.spv.hpp"
#include "kernels/material_raster_place.spv.hpp"
#include "mesh.hpp"

namespace inverse {

/// Pose of a mesh in an image under orthographic projection, or behind a lens.
struct MeshView {
  using Row = std::array<float, 3>;
  std::array<Row, 3> turn{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< rows of a rotation
  float scale = 1;                                             ///< pixels a unit
  float x = 0, y = 0;  ///< position of the mesh's origin, pixels; pixel centers are at halves
  /// Behind a lens scale and position are in meters from the camera: x right, y up, z towards it,
  /// so that what is seen has z < 0. Triangles with a corner nearer than 2 cm are not drawn.
  float z = 0;
  std::array<float, 4> lens{};  ///< focal lengths and center in pixels; 0: orthographic
  bool operator==(const MeshView&) const = default;
};

/// Rasterizes meshes by compute. Corners are projected; edge functions of triangles are set up in
/// groups of spatial neighbors; each tile marks the groups that may be visible in it; each pixel
/// finds the nearest triangle at eight samples. Without atomics or lists, the result is
/// deterministic, and memory depends only on the mesh and the image size. Edges are inclusive, so
/// that closed meshes have no cracks.
class Rasterizer {
 public:
  /// `mesh` has to be prepared (Mesh::prepare).
  Rasterizer(const std::shared_ptr<gpu::Device>& device, const Mesh& mesh);

  /// Draws it with the table of a lit sphere: linear RGB times coverage, w = coverage.
  void draw(gpu::Commands& commands, const MeshView& view, const Plane& table,
            const Plane& picture);
  /// A remembered scene around it (draw_room.comp).
  struct Room {
    gpu::BufferPtr room, surface, reached;
  };
  /// The same of what is not behind the scene, in the light that passes it. `view` has a lens.
  void draw_in_room(gpu::Commands& commands, const MeshView& view, const Plane& table,
                    const Room& room, const Plane& picture);
  /// x = mean depth (pixels towards the camera, from the mesh's origin) where it covers a pixel, y
  /// = coverage.
  void depth(gpu::Commands& commands, const MeshView& view, const Plane& picture) {
    depth(commands, view, picture, {0, 0}, picture.extent);
  }
  /// The same for a part of a picture, whose pixels `view` counts from its corner.
  void depth(gpu::Commands& commands, const MeshView& view, const Plane& picture, Extent corner,
             Extent part);

 private:
  using Grid = shaders::material_raster_draw::Push;  // of draw_, draw_room_ and depth_
  Grid prepare(gpu::Commands& commands, const MeshView& view, Extent extent);

  gpu::Program<shaders::material_raster_place> place_;
  gpu::Program<shaders::material_raster_edges> edges_;
  gpu::Program<shaders::material_raster_bin> bin_;
  gpu::Program<shaders::material_raster_draw> draw_;
  gpu::Program<shaders::material_raster_draw_room> draw_room_;  // made when it is first used
  gpu::Program<shaders::material_raster_depth> depth_;
  uint32_t corner_count_, triangles_, group_, groups_;
  gpu::BufferPtr corners_, indices_, placed_, records_, boxes_, bounds_, bits_;
};

}  // namespace inverse
