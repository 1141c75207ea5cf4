// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <optional>

#include "kernels/edit_base_key.spv.hpp"
#include "kernels/edit_recolor.spv.hpp"
#include "kernels/edit_recolor_base.spv.hpp"
#include "kernels/edit_recolor_cluster.spv.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"
#include "kernels/palette/scene_palette.hpp"
#include "light_edit.hpp"

namespace inverse {

/// What to recolor, and into what. Colors are linear RGB reflectances in the scale of the intrinsic
/// layer.
struct RecolorParams {
  /// −1: what `cluster` or the key says. 0…kMaxBases − 1: the surfaces of that base color of
  /// bounced light (Role::bases), by the chromaticity of unedited reflectance; their mean color
  /// takes the key's place and the tolerances are not used. Frames without such a color stay as
  /// they are.
  int base = kByKey;
  /// −1: what the key says. 0…clusters − 1: the pixels nearest to that cluster of the unedited
  /// reflectance; its mean color takes the key's place and the tolerances are not used.
  int cluster = kByKey;
  /// How many clusters the palette looks for, 1…Palette::kMaxClusters.
  int clusters = 10;
  /// A color of the region. Its chromaticity K / mean K selects; its mean K is the value that
  /// becomes the target's.
  std::array<float, 3> key{0.5f, 0.05f, 0.05f};
  /// How far a pixel's chromaticity c = R / mean R may be from the key's and still count as the
  /// same: Euclidean distance. Gray is 2.45 from a pure primary, two primaries are 4.25 apart.
  float tolerance = 0.4f;
  /// How far a pixel's mean reflectance may be from the key's: |ln ratio|. kAnyValue: no limit.
  float value_tolerance = kAnyValue;
  /// Over what distance beyond either tolerance the selection falls to 0, in the same units; with
  /// clusters, over what difference between the distances to the nearest two, in ln R; with base
  /// colors, in ln chromaticity. 0: a hard edge.
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
  static constexpr int kByKey = -1;
};

/// Gives one color of the scene another: R' = R + w (R_target − R). Shading stays; where light has
/// layers (Layers::global), so does its amount, and what bounced off the recolored surfaces takes
/// their new color (LightEdit).
class Recolor {
 public:
  Recolor(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Records the edit of `layers` (Role::intrinsic must be there). Planes that somebody else holds
  /// are left alone: the edit goes to a fresh one. Nothing is recorded and the layers stay as they
  /// are where strength is 0 and no mask is asked for. Values that are not finite are taken as 0
  /// (infinity: as 65504), colors and numbers of `params` are clamped to their ranges.
  ///
  /// With a cluster or a base color, Role::model must be there too: it feeds the palette, so that
  /// editors one after the other mean the same color by the same index.
  void record(gpu::Commands& commands, Layers& layers, const RecolorParams& params);

  /// Forgets the clusters of earlier frames.
  void reset();

  /// The clusters in use, or null where no cluster was asked for yet.
  const Palette* palette() const { return palette_ ? &palette_->palette() : nullptr; }

 private:
  std::shared_ptr<gpu::Device> device_;
  PlanePool planes_;
  gpu::BufferPtr nothing_, no_bases_, base_color_;
  gpu::Program<shaders::edit_base_key> base_key_;
  // By MATTE + 2 PUBLISH.
  std::array<gpu::Program<shaders::edit_recolor>, 4> by_key_;
  std::array<gpu::Program<shaders::edit_recolor_cluster>, 4> by_cluster_;
  std::array<gpu::Program<shaders::edit_recolor_base>, 4> by_base_;
  std::optional<ScenePalette> palette_;  // made when a cluster is first asked for
  std::optional<LightEdit> light_;       // made when light first has layers
};

/// The plane to write the edited `plane` to: itself where nobody else holds it, else a fresh one.
PlanePtr plane_to_edit(const PlanePtr& plane, PlanePool& planes);

}  // namespace inverse
