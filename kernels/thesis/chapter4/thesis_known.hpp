// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <vector>

#include "kernels/camera/known_reflectance.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/thesis_chapter4_known.spv.hpp"

namespace inverse {

/// What is known of a frame's reflectance on the levels of a pyramid (4.8, known.glsl).
class ThesisKnownTerm {
 public:
  explicit ThesisKnownTerm(const std::shared_ptr<gpu::Device>& device);

  /// Makes buffers for levels of these sizes, finest first, when they are first needed.
  void set_levels(std::vector<Extent> levels);
  struct Frame {
    gpu::BufferPtr image;  ///< of the finest level, linear light
    gpu::BufferPtr scale;  ///< ScaleNormalization::value of the frame before
    float log_floor, chroma_floor;
  };
  /// Records what is known of a frame on the finest level; null: nothing is. The others are to be
  /// sampled down from it if there is a weight.
  void record(gpu::Commands& commands, const KnownReflectance* known, const Frame& frame);

  /// w_s; 0: nothing is known.
  float weight() const { return weight_; }
  /// The input of known.glsl; without weight of any content.
  const gpu::BufferPtr& targets(size_t level) const {
    return weight_ > 0 ? targets_[level] : nothing_;
  }

 private:
  std::shared_ptr<gpu::Device> device_;
  gpu::Program<shaders::thesis_chapter4_known> known_;
  std::vector<Extent> levels_;
  std::vector<gpu::BufferPtr> targets_;
  gpu::BufferPtr nothing_;
  float weight_ = 0;
};

}  // namespace inverse
