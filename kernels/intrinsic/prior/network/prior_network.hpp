// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <optional>

#include "kernels/image/tiles/tile_list.hpp"
#include "kernels/intrinsic/guide/guide.hpp"
#include "kernels/intrinsic_prior_network_input.spv.hpp"
#include "kernels/intrinsic_prior_network_output.spv.hpp"
#include "kernels/intrinsic_prior_network_reflectance.spv.hpp"
#include "kernels/network/network.hpp"
#include "network_rate.hpp"
#include "prior_model.hpp"

namespace inverse {

/// The picture that a PriorNetwork sees of a frame.
struct PriorPicture {
  uint32_t level = 0;  ///< a pixel of it is 2^level x 2^level pixels of the frame
  Extent extent;       ///< at most PriorModel::kMaxSide along a side
  Extent padded;       ///< to multiples of PriorModel::kStep
  explicit PriorPicture(Extent frame);
};

/// What a network adds to the fitted prior of a frame, from its guide
/// (docs/reference/methods/intrinsicdecomp.md, 2), for frames of one size on one device.
class PriorNetwork {
 public:
  /// Throws Error(limit) and Error(out_of_memory).
  PriorNetwork(const std::shared_ptr<gpu::Device>& device, Extent frame, PriorModelPtr model);

  const PriorModelPtr& model() const { return model_; }
  const PriorPicture& picture() const { return picture_; }
  /// If no tile is `listed`, the fields stay. On the host, one run serves `interval` frames while
  /// the picture hardly changes (NetworkRate).
  void record(gpu::Commands& commands, const Guide& guide, uint32_t interval = 1,
              const TileList* listed = nullptr);
  /// How many frames before the last one recorded the network ran.
  uint32_t age() const { return rate_.age(); }
  /// How often it ran on the host; 0 elsewhere.
  uint32_t runs() const { return rate_.runs(); }
  /// The next frame has nothing to do with the last one.
  void reset() { rate_.reset(); }
  /// One vec4 a pixel of the picture (fields.glsl).
  const gpu::BufferPtr& fields() const { return fields_; }
  const network::Network& network() const { return network_; }

 private:
  PriorPicture picture_;
  PriorModelPtr model_;
  network::Network network_;
  gpu::Program<shaders::intrinsic_prior_network_input> input_;
  std::optional<gpu::Program<shaders::intrinsic_prior_network_output>> output_;
  std::optional<gpu::Program<shaders::intrinsic_prior_network_reflectance>> reflectance_;
  gpu::BufferPtr fields_;
  NetworkRate rate_;
};

}  // namespace inverse
