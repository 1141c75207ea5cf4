// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "kernels/edit_selection_object_claim.spv.hpp"
#include "kernels/edit_selection_object_count.spv.hpp"
#include "kernels/edit_selection_object_diffuse.spv.hpp"
#include "kernels/edit_selection_object_keep.spv.hpp"
#include "kernels/edit_selection_object_label.spv.hpp"
#include "kernels/edit_selection_object_learn.spv.hpp"
#include "kernels/edit_selection_object_marks.spv.hpp"
#include "kernels/edit_selection_object_near.spv.hpp"
#include "kernels/edit_selection_object_occupied.spv.hpp"
#include "kernels/edit_selection_object_paths.spv.hpp"
#include "kernels/edit_selection_object_remember.spv.hpp"
#include "kernels/edit_selection_object_smooth.spv.hpp"
#include "kernels/edit_selection_object_start.spv.hpp"
#include "kernels/edit_selection_object_terms.spv.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/image/components/components.hpp"
#include "seeds.hpp"

namespace inverse {

/// Selects an object that a user points at, and follows it through the frames
/// (tests/reference/edit/selection/object.hpp).
///
/// Densities of color of the object and of the background tell the cells of the two apart. Cells
/// whose colors are in neither, or in both, go by their neighbors across weak edges, and by the
/// nearer stroke if there are strokes that add and that subtract. The object is what is connected
/// to the user's strokes, later to itself in the frame before. Both densities are learned from what
/// was selected. A cell remembers strokes until its color changes.
class ObjectSelection {
 public:
  ObjectSelection(const std::shared_ptr<gpu::Device>& device, const CellGrid& grid);

  /// Selects the object under these strokes, in addition to the one that is selected unless
  /// `restart`. `colors` are those of the frame's cells (cells.comp).
  void select(gpu::Commands& commands, const gpu::BufferPtr& colors,
              std::span<const SelectionStroke> strokes, Extent drawn, bool restart);
  /// Finds the object in another frame.
  void follow(gpu::Commands& commands, const gpu::BufferPtr& colors);
  void reset() { active_ = false; }
  /// The next frame is of another time: the object may be anywhere in it, or not at all. It is
  /// found by its colors, and by strokes on what has kept its place and color.
  void lose(gpu::Commands& commands);
  /// What was selected and learned, to come back to; empty if nothing was.
  using State = std::vector<gpu::BufferPtr>;
  State save(gpu::Commands& commands);
  void restore(gpu::Commands& commands, const State& state);
  /// Whether anything was selected.
  bool active() const { return active_; }

  /// Of every stroke of the last `select`.
  const std::vector<SeedCells>& stroke_cells() const { return stroke_cells_; }

  /// Of every cell: how far it belongs to the object, 0 to 1, and a word that is 1 if it does.
  const gpu::BufferPtr& alpha() const { return alpha_[0]; }
  const gpu::BufferPtr& region() const { return region_; }

  /// The object's place, from words that a frame left in `status()`.
  struct Place {
    double share = 0;                                 ///< of the frame
    double x = 0, y = 0;                              ///< center, pixels
    double left = 0, top = 0, right = 0, bottom = 0;  ///< pixels
  };
  static constexpr uint32_t kStatusWords = shaders::edit_selection_object_count::kStatusWords;
  const gpu::BufferPtr& status() const { return status_; }
  Place place_of(const uint32_t* status) const;

 private:
  /// Finds the cells under strokes, with those that were drawn now.
  void mark(gpu::Commands& commands, const gpu::BufferPtr& colors, const gpu::BufferPtr& drawn);
  /// Finds which strokes are nearest to each cell.
  void find_paths(gpu::Commands& commands, const gpu::BufferPtr& colors);
  /// `steps` of diffusion from the alpha that there is, then the components that belong to it.
  void segment(gpu::Commands& commands, const gpu::BufferPtr& colors, uint32_t steps);
  void find_region(gpu::Commands& commands, bool seeded);
  void learn(gpu::Commands& commands, const gpu::BufferPtr& colors, float rate);
  /// Learns one of the densities (object.glsl).
  void learn(gpu::Commands& commands, const gpu::BufferPtr& colors, int density, float rate);
  /// The buffers that a frame leaves to the next one.
  std::array<gpu::BufferPtr*, 9> lasting() {
    return {&alpha_[0], &region_, &memory_, &terms_,    &near_,
            &model_,    &totals_, &status_, &last_area_};
  }
  gpu::Items per_cell() const { return {grid_.cells.width, grid_.cells.height}; }

  CellGrid grid_;
  Extent blocks_;
  gpu::Program<shaders::edit_selection_object_count>
      count_[shaders::edit_selection_object_count::kDensities];
  gpu::Program<shaders::edit_selection_object_smooth> smooth_counts_, smooth_again_;
  gpu::Program<shaders::edit_selection_object_learn> learn_, raise_;
  gpu::Program<shaders::edit_selection_object_start> start_;
  gpu::Program<shaders::edit_selection_object_marks> marks_;
  gpu::Program<shaders::edit_selection_object_paths> first_rows_, rows_, columns_;
  gpu::Program<shaders::edit_selection_object_remember> remember_;
  gpu::Program<shaders::edit_selection_object_terms> terms_of_;
  gpu::Program<shaders::edit_selection_object_diffuse> diffuse_first_, diffuse_;
  gpu::Program<shaders::edit_selection_object_label> label_;
  gpu::Program<shaders::edit_selection_object_claim> claim_;
  gpu::Program<shaders::edit_selection_object_keep> keep_, keep_seeded_;
  gpu::Program<shaders::edit_selection_object_occupied> occupy_;
  gpu::Program<shaders::edit_selection_object_near> near_of_;
  Components components_;
  gpu::BufferPtr alpha_[2], region_, drawn_, none_drawn_, seeds_, memory_, paths_, terms_, labels_,
      claims_;
  gpu::BufferPtr counts_, smoothed_[2], model_, totals_, occupied_, near_, status_, last_area_;
  std::vector<SeedCells> stroke_cells_;
  bool active_ = false, lost_ = false;
};

}  // namespace inverse
