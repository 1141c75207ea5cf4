#pragma once
#include <memory>

#include "../gpu/commands.hpp"

namespace inverse {

/// The specular layer of an object as lines of the picture's least channel, point by point: layer =
/// slope * channel + offset around each. Networks find the layer at few points; by these lines it
/// has the edges that the whole frame shows (guided filter: He, Sun and Tang, Guided Image
/// Filtering, 2010; at few points: He and Sun, Fast Guided Filter, 2015).
class GuidedLayer {
 public:
  /// For squares of side x side points.
  GuidedLayer(const std::shared_ptr<gpu::Device>& device, uint32_t side);

  /// `masked` and `codes` are SpecularNet's and ExponentNet's input: sRGB where the object is with
  /// its mask, and the code of the specular layer in x.
  void record(gpu::Commands& commands, const gpu::BufferPtr& masked, const gpu::BufferPtr& codes);

  /// side x side points: slope, 0 to 1, and offset, in linear light; 0 where no object is near.
  const gpu::BufferPtr& lines() const { return mean_of_lines_; }

 private:
  uint32_t side_;
  gpu::KernelPtr find_points_, find_lines_, find_mean_;
  gpu::BufferPtr points_, lines_, mean_of_lines_;
};

}  // namespace inverse
