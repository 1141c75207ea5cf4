#pragma once
#include <array>

#include "../gpu/commands.hpp"
#include "../image/layers.hpp"

namespace inverse {

/// What to recolor, and into what. Colors are linear RGB reflectances in the scale of the intrinsic
/// layer.
struct RecolorParams {
  /// A color of the region. Its chromaticity K / mean K selects; its mean K is the value that
  /// becomes the target's.
  std::array<float, 3> key{0.5f, 0.05f, 0.05f};
  /// How far a pixel's chromaticity c = R / mean R may be from the key's and still count as the
  /// same: Euclidean distance. Gray is 2.45 from a pure primary and 0 from any other gray.
  float tolerance = 0.4f;
  /// How far a pixel's mean reflectance may be from the key's: |ln ratio|. kAnyValue: no limit.
  float value_tolerance = kAnyValue;
  /// Over what distance beyond either tolerance the selection falls to 0, in the same units; 0: a
  /// hard edge.
  float softness = 0.3f;
  /// The reflectance that the key becomes.
  std::array<float, 3> target{0.05f, 0.2f, 0.5f};
  /// How much of the region's own variation in value stays: R' = target · (mean R / mean
  /// K)^texture.
  float texture = 1.0f;
  /// 0: nothing changes; 1: fully recolored where selected.
  float strength = 1.0f;
  /// Multiply the selection by the mask layer where there is one.
  bool use_mask = true;
  /// Leave the selection (times the mask, if used) behind as the mask layer for what follows.
  bool write_mask = false;

  static constexpr float kAnyValue = 20.0f;
};

/// Gives one color of the scene another: R' = R + w (R_target − R). Shading stays.
class Recolor {
 public:
  Recolor(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Records the edit of `layers` (Role::intrinsic must be there). Planes that somebody else holds
  /// are left alone: the edit goes to a fresh one. Nothing is recorded and the layers stay as they
  /// are where strength is 0 and no mask is asked for. Values that are not finite are taken as 0
  /// (infinity: as 65504), colors and numbers of `params` are clamped to their ranges.
  void record(gpu::Commands& commands, Layers& layers, const RecolorParams& params);

 private:
  std::shared_ptr<gpu::Device> device_;
  PlanePool planes_;
  gpu::BufferPtr nothing_;
  std::array<gpu::KernelPtr, 4> kernels_;  // by MATTE + 2 PUBLISH
};

/// The plane to write the edited `plane` to: itself where nobody else holds it, else a fresh one.
PlanePtr plane_to_edit(const PlanePtr& plane, PlanePool& planes);

}  // namespace inverse
