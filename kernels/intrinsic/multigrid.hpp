#pragma once
#include <cstdint>
#include <vector>

#include "quads.hpp"

namespace inverse {

/// V-cycles for the linear system of one unknown a pixel and four neighbors (energy.glsl), symmetric and positive
/// definite. Levels shrink 2:1 to a single pixel; aggregates of 2 x 2 pixels carry corrections; blocks of 4 x 4 pixels
/// are relaxed in checkerboard order. Levels of few pixels run together in one dispatch.
class Multigrid {
 public:
  struct Params {
    /// Relaxations before and after every coarse correction, 1…4.
    uint32_t passes = 1;
    /// The same on the levels that run in one dispatch, 1…8.
    uint32_t coarse_passes = 1;
    /// Factor on coarse edges, 0.5…1. Sums of edges (1) bind aggregates twice as strongly as the smooth functions that
    /// they stand for; 0.5 is right for equal weights, more is safer where weights jump.
    float scale = 0.6F;
  };

  /// Throws Error(limit) where a level does not fit the device.
  Multigrid(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// The system, four vec4 a quad: weights of the edges to the right and down, mass, right-hand side.
  const gpu::BufferPtr& system() const { return levels_[0].system; }
  /// The unknown, one vec4 a quad; cycles improve it in place.
  const gpu::BufferPtr& field() const { return levels_[0].field; }
  /// Records one V-cycle.
  void record(gpu::Commands& commands, const Params& params) const;
  /// How many levels there are, the single pixel included.
  uint32_t depth() const { return depth_; }

 private:
  struct Level {
    Extent extent;
    gpu::BufferPtr system, field;
  };
  void smooth(gpu::Commands& commands, const Level& level, uint32_t color) const;

  std::vector<Level> levels_;  // the last one holds all that run in one dispatch
  uint32_t depth_ = 1;
  gpu::KernelPtr smooth_, descend_, ascend_, coarse_;
};

}  // namespace inverse
