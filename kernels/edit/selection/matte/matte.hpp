// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <map>
#include <memory>

#include "kernels/edit/selection/grid.hpp"
#include "kernels/edit_selection_matte_classify.spv.hpp"
#include "kernels/edit_selection_matte_matte.spv.hpp"
#include "kernels/edit_selection_matte_reduce.spv.hpp"
#include "kernels/edit_selection_matte_sides.spv.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"

namespace inverse {

/// What a new selection does to the mask that came in.
enum class Combine : uint8_t { replace, add, subtract, intersect };

/// Turns a selection of cells or of pixels into a matte whose soft edges follow the frame's
/// (tests/reference/edit/selection/matte.hpp): light at the border is a mixture of the object's and
/// of what is behind it, and alpha is the object's part.
class Matte {
 public:
  Matte(const std::shared_ptr<gpu::Device>& device, const CellGrid& grid);

  struct Settings {
    Combine combine = Combine::replace;
    bool invert = false;
    bool soft = true;  ///< else edges are hard
  };
  /// A selection of cells: ObjectSelection's.
  struct Cells {
    const gpu::BufferPtr& alpha;
    const gpu::BufferPtr& region;
  };

  /// Writes Role::mask of `layers`. `light` has the mean light of each cell (cells.comp).
  void record(gpu::Commands& commands, Layers& layers, const gpu::BufferPtr& light,
              const Cells& cells, const Settings& settings);
  /// The same for a selection of pixels, in x of a plane.
  void record(gpu::Commands& commands, Layers& layers, const gpu::BufferPtr& light,
              const Plane& selection, const Settings& settings);

 private:
  void write(gpu::Commands& commands, Layers& layers, const gpu::BufferPtr& light,
             const gpu::BufferPtr& alpha, const gpu::BufferPtr& region, const Plane* selection,
             const Settings& settings);

  std::shared_ptr<gpu::Device> device_;
  CellGrid grid_;
  PlanePool planes_;
  gpu::Program<shaders::edit_selection_matte_reduce> reduce_;
  gpu::Program<shaders::edit_selection_matte_classify> classify_;
  gpu::Program<shaders::edit_selection_matte_sides> sides_;
  gpu::BufferPtr region_, classes_, object_, behind_, nothing_;
};

}  // namespace inverse
