#pragma once
#include <memory>

#include "../gpu/commands.hpp"
#include "../image/plane.hpp"

namespace inverse {

/// The color of the light in a frame: what its surfaces send each other, on a small grid, and from
/// that the tint of the light at every pixel (docs/method-globalintrinsic.md). Owns the kernels and
/// the temporal state for one size on one device. Not thread-safe.
class LightModel {
 public:
  struct Params {
    /// Above 0: the amount of indirect light, beside that which the image sends, 0…4; 0: measured.
    float amount = 0;
    float near = 0.7F;     ///< share of light from around in that from the whole frame, 0…1
    float own = 0.8F;      ///< share of a color's own light that it does not see, 0…1
    float reach = 0.4F;    ///< standard deviation of light's way, of the grid's width
    float neutral = 1.5F;  ///< weight of neutrality beside sharpness, 0…100
    float typical_amount = 0.5F;  ///< of a scene that says nothing, 0.06…1.5
    float amount_spread = 0.65F;  ///< standard deviation of its logarithm among scenes, 0.01…10
    float trust = 8;              ///< log-likelihood of a difference of cost of 1, 0…1e3
    float least_share = 0.004F;   ///< of the frame that a base color has at least, 0.004…1
    float same_color = 0.3F;      ///< log chroma up to which a base color stays itself, 0…10
    float edge = 0.01F;           ///< variance of log chroma that counts as an edge, above 0
    float gate = 0.01F;  ///< mean square tint of a scene that takes half of the residual, above 0
    float renew = 0.2F;  ///< share of a frame in what is carried from frame to frame, 0…1
    float cut = 0.3F;    ///< change of chroma from which on a frame is a cut, 0…1
    bool operator==(const Params&) const = default;
  };
  static constexpr uint32_t kSlots = 16;       ///< base colors at most
  static constexpr uint32_t kMostPoints = 40;  ///< along a side of the grid

  /// What the solver knew of the frame before, and of its own output's scale.
  struct Before {
    gpu::BufferPtr memory;   ///< m of quads of pixels (temporal.glsl)
    gpu::BufferPtr shading;  ///< s of quads of pixels
    gpu::BufferPtr gauge;    ///< ln of the output's scale
  };

  LightModel(std::shared_ptr<gpu::Device> device, Extent extent);

  /// Records the look at the grid and writes the frame without its tint to `plain` and the tint's
  /// log chroma and base color (x, y, z) to `tints`. `first`: there was no frame before.
  void record(gpu::Commands& commands, const PlanePtr& frame, const Before& before, bool first,
              const Params& params, const PlanePtr& plain, const PlanePtr& tints);
  /// Records the split of the light of shading `intrinsic`.w into `layers` (indirect, direct) and
  /// `reflectance` (frame over light, mean light).
  void record_split(gpu::Commands& commands, const PlanePtr& frame, const PlanePtr& intrinsic,
                    const PlanePtr& tints, const PlanePtr& layers, const PlanePtr& reflectance);

  Extent grid() const { return grid_; }
  uint32_t factor() const { return factor_; }
  const gpu::BufferPtr& scene() const { return scene_; }  ///< global.glsl: SCENE_…
  const gpu::BufferPtr& base() const {
    return base_;
  }  ///< vec4 a slot: log chroma, 1 if used, mass; then how many are used
  const gpu::BufferPtr& costs() const { return carried_costs_; }
  const gpu::BufferPtr& lit() const { return lit_; }  ///< vec4 a point: tint, fraction, weight

 private:
  void gather(gpu::Commands& commands, const Params& params);
  void weigh(gpu::Commands& commands, const Params& params);
  void smooth(gpu::Commands& commands, const Params& params);

  Extent extent_, grid_, half_;
  uint32_t factor_;
  gpu::KernelPtr grid_kernel_, scene_kernel_, emit_, rows_, columns_, receive_, gather_, amount_,
      kappa_, light_, modes_, residual_kernel_, believe_, fit_, average_, tint_, split_;
  gpu::BufferPtr points_, cues_, cues_before_, scene_, labels_, emitted_, blurred_, received_,
      lights_, costs_, carried_costs_, lit_, histogram_, carried_, heights_, words_, table_, base_,
      residual_, believed_, means_, models_, averaged_;
  bool cleared_ = false;
};

}  // namespace inverse
