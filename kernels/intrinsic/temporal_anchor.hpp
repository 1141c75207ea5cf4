#pragma once
#include <memory>

#include "guide.hpp"

namespace inverse {

/// What a frame leaves to the next one, and how far the next one may believe it (temporal.glsl;
/// docs/method-intrinsicdecomp.md, 6). Cuts are found on the device, so that nothing waits for the
/// host.
class TemporalAnchor {
 public:
  struct Params {
    /// Weight of the previous frame's reflectance where nothing moves but the light, pixel by
    /// pixel, 0…1e3; 0 switches it off.
    float anchor_weight = 1.0F;
    /// Change of chroma that halves it, natural log units, 1e-3…10.
    float anchor_chroma = 0.2F;
    /// Change of local log contrast that halves it, 1e-3…10.
    float anchor_detail = 1.0F;
    /// Deviation of the change of log intensity inside a cell that halves it, 1e-3…10.
    float anchor_texture = 0.3F;
    /// How many times the weight is added where the light stays, too, 0…100: without new light
    /// there is nothing to learn, and sensor noise to withstand.
    float anchor_still = 5.0F;
    /// Change of a cell's log intensity that halves that, 1e-3…10.
    float anchor_light = 0.02F;
    /// Mean mismatch of a frame, 0…1, from which on it is a cut.
    float cut_fraction = 0.3F;
    bool operator==(const Params&) const = default;
  };
  TemporalAnchor(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Records how far the frame of `guide` matches the one kept; needs `kept` and `mean` of one.
  void record(gpu::Commands& commands, const Guide& guide, const Params& params);
  const gpu::BufferPtr& kept() const {
    return kept_;
  }  ///< vec4 a cell: d, c0, c1, m'; layers.comp writes it
  const gpu::BufferPtr& mean() const {
    return mean_;
  }  ///< vec4 a quad of pixels: m; assemble.comp writes it
  const gpu::BufferPtr& mismatch() const { return mismatch_; }  ///< of cells
  const gpu::BufferPtr& tiles() const { return tiles_; }        ///< mean mismatch of 4 x 4 cells
  const gpu::BufferPtr& verdict() const {
    return verdict_;
  }  ///< mean mismatch; 1 anchored or 0 cut

 private:
  Extent extent_, cells_;
  gpu::KernelPtr compare_, calm_, decide_;
  gpu::BufferPtr kept_, mean_, mismatch_, tiles_, sums_, verdict_;
  bool cleared_ = false;
};

}  // namespace inverse
