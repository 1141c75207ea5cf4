// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/lightstage/lights/light_cells.hpp"
#include "kernels/lightstage_lobe_directions.spv.hpp"
#include "kernels/lightstage_lobe_light_table.spv.hpp"
#include "kernels/lightstage_lobe_lobes.spv.hpp"
#include "kernels/lightstage_lobe_relight.spv.hpp"
#include "kernels/lightstage_lobe_relight_sum.spv.hpp"
#include "kernels/lightstage_lobe_respond.spv.hpp"
#include "lobe_moments.hpp"

namespace inverse {

/// Two frames under color gradients, each a part of a plane: two planes, or one that holds both
/// side by side.
struct GradientPair {
  const Plane& a;
  const Plane& b;
  uint32_t second = 0;  ///< first column of b
};

/// Relights a subject with one cosine lobe per pixel (Fyffe et al. 2009; lobe.glsl), for frames of
/// one size from one stage.
class CosineLobe {
 public:
  struct Params {
    /// A + B (linear, 1 = full scale) at noise level: directions fade out below it.
    float noise = 0.002F;
    bool operator==(const Params&) const = default;
  };

  CosineLobe(const std::shared_ptr<gpu::Device>& device, Extent extent,
             std::shared_ptr<const LobeMoments> moments, std::span<const Direction> lights);

  /// Computes the lobes of a frame. NaN and negative input counts as 0, infinity as the largest
  /// value; results are finite.
  void record_lobes(gpu::Commands& commands, const GradientPair& pair, const Params& params);
  /// A + B: the subject under all lights; w = alpha of A.
  const PlanePtr& full() const { return full_; }
  const PlanePtr& lobes() const { return lobes_; }

  /// Uses these lights from the next `record_relit` on; records making a table of them.
  void record_lights(gpu::Commands& commands, std::span<const WeightedLight> lights);
  /// Draws the subject under them, linear RGB; w = alpha. Takes constant time in the number of
  /// lights, by a table of 4225 directions and 13 exponents; within 2 % of `record_sum`.
  void record_relit(gpu::Commands& commands, const Plane& target) const;
  /// Draws the subject under lights of any directions, summed one after the other.
  void record_sum(gpu::Commands& commands, std::span<const WeightedLight> lights,
                  const Plane& target);
  /// Draws directions as a normal map.
  void record_directions(gpu::Commands& commands, const Params& params, const Plane& target) const;
  /// Response of these pixels to each light of the stage with weight 1: RGB and a zero, pixel by
  /// pixel, light by light. `samples` holds pixels as words.
  void record_responses(gpu::Commands& commands, const gpu::BufferPtr& samples,
                        const gpu::BufferPtr& responses) const;

 private:
  void make_gains(gpu::Commands& commands);
  /// Into lights_.
  void write_lights(gpu::Commands& commands, std::span<const WeightedLight> lights);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  std::shared_ptr<const LobeMoments> moments_;
  uint32_t stage_lights_;
  gpu::Program<shaders::lightstage_lobe_lobes> find_;
  gpu::Program<shaders::lightstage_lobe_light_table> table_kernel_;
  gpu::Program<shaders::lightstage_lobe_relight> relight_;
  gpu::Program<shaders::lightstage_lobe_relight_sum> sum_;
  gpu::Program<shaders::lightstage_lobe_respond> respond_;
  gpu::Program<shaders::lightstage_lobe_directions> directions_;
  gpu::BufferPtr grid_, stage_, gains_, table_, lights_;
  bool has_gains_ = false;
  Rgb even_{};
  PlanePtr full_, lobes_;
};

}  // namespace inverse
