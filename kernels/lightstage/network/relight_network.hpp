// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <span>

#include "kernels/lightstage/lights/measured_light.hpp"
#include "kernels/lightstage/lobe/cosine_lobe.hpp"
#include "kernels/lightstage_network_encode.spv.hpp"
#include "kernels/lightstage_network_head_respond.spv.hpp"
#include "kernels/lightstage_network_head_sum.spv.hpp"
#include "kernels/network/network.hpp"
#include "relight_models.hpp"

namespace inverse {

/// Relights a subject by a network (thesis 7.4, with late fusion of directions from its outlook):
/// features once per frame, then two small layers per light, for frames of one size and lights of
/// any direction.
class RelightNetwork {
 public:
  RelightNetwork(const std::shared_ptr<gpu::Device>& device, Extent extent,
                 const RelightModels& models);

  /// Computes the features of a frame.
  void record_features(gpu::Commands& commands, const GradientPair& pair);
  /// Draws the subject under lights, plus the measured light if that is not dark, linear RGB; w as
  /// in `full` (CosineLobe::full of the same frame). `share`: solid angle of a light of weight 1
  /// relative to the sphere (1/N for N lights all around); `noise`: CosineLobe::Params.
  void record_sum(gpu::Commands& commands, const Plane& full, std::span<const WeightedLight> lights,
                  double share, const Plane& target, const MeasuredLight& measured = {},
                  float noise = CosineLobe::Params{}.noise);
  /// As CosineLobe::record_responses.
  void record_responses(gpu::Commands& commands, const Plane& full,
                        std::span<const Direction> lights, double share,
                        const gpu::BufferPtr& samples, const gpu::BufferPtr& responses);

  /// Features of the last `record_features`: a value of 64 channels of size `padded()`.
  const gpu::BufferPtr& features() const { return network_.output(0); }
  Extent padded() const { return padded_; }
  /// Device memory of weights and images, bytes.
  uint64_t bytes() const {
    return network_.weight_bytes() + network_.plan().bytes() + difference_->bytes();
  }

 private:
  /// Into lights_; returns how many, filled up to a multiple of kAtOnce.
  uint32_t write_lights(gpu::Commands& commands, std::span<const WeightedLight> lights,
                        double share);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_, padded_;
  RelightModels head_;  // its layers for the lights
  network::Network network_;
  gpu::Program<shaders::lightstage_network_encode> encode_;
  gpu::Program<shaders::lightstage_network_head_sum> sum_;
  gpu::Program<shaders::lightstage_network_head_respond> respond_;
  gpu::BufferPtr weights_, difference_, lights_;
};

}  // namespace inverse
