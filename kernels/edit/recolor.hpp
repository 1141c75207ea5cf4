// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <optional>

#include "kernels/edit_base_key.spv.hpp"
#include "kernels/edit_mask_key.spv.hpp"
#include "kernels/edit_recolor.spv.hpp"
#include "kernels/edit_recolor_base.spv.hpp"
#include "kernels/edit_recolor_cluster.spv.hpp"
#include "kernels/edit_recolor_mask.spv.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"
#include "kernels/palette/scene_palette.hpp"
#include "light_edit.hpp"

namespace inverse {

/// Selection and target of a recoloring. Colors are linear RGB reflectances in the scale of the
/// intrinsic layer.
struct RecolorParams {
  /// The mask layer selects alone; frames without one are not edited, and nothing of them is
  /// selected. Its mean color replaces the key; base, cluster and the tolerances are not used.
  bool by_mask = false;
  /// −1: by `cluster` or the key. 0…kMaxBases − 1: the surfaces of that base color of bounced light
  /// (Role::bases), by the chromaticity of unedited reflectance; their mean color replaces the key,
  /// and the tolerances are not used. Frames without such a color are not edited.
  int base = kByKey;
  /// −1: by the key. 0…clusters − 1: the pixels nearest to that cluster of the unedited
  /// reflectance; its mean color replaces the key, and the tolerances are not used.
  int cluster = kByKey;
  /// Number of clusters of the palette, 1…Palette::kMaxClusters.
  int clusters = 10;
  /// A color of the region. Its chromaticity K / mean K selects; its mean K is the value that
  /// becomes the target's.
  std::array<float, 3> key{0.5f, 0.05f, 0.05f};
  /// Max distance of a pixel's chromaticity c = R / mean R from the key's: Euclidean. Gray is 2.45
  /// from a pure primary, two primaries are 4.25 apart.
  float tolerance = 0.4f;
  /// Max distance of a pixel's mean reflectance from the key's: |ln ratio|. kAnyValue: no limit.
  float value_tolerance = kAnyValue;
  /// Distance beyond either tolerance over which the selection falls to 0, in the same units; with
  /// clusters, of the difference between the distances to the nearest two, in ln R; with base
  /// colors, in ln chromaticity. 0: a hard edge.
  float softness = 0.3f;
  /// The reflectance that the key becomes.
  std::array<float, 3> target{0.05f, 0.2f, 0.5f};
  /// How much of the region's own variation in value stays: R' = target · (mean R / mean
  /// K)^texture.
  float texture = 1.0f;
  /// How much of the region's own mean value stays: the target is multiplied by (mean K / mean
  /// target)^brightness.
  float brightness = 0.0f;
  /// The region keeps its colors, but for their hue; the target is not used.
  bool own_color = false;
  /// Turns the new color around the axis of grays in linear RGB, degrees.
  float hue_shift = 0.0f;
  /// 0: nothing changes; 1: the selection is fully recolored.
  float strength = 1.0f;
  /// Multiply the selection by the mask layer if there is one.
  bool use_mask = true;
  /// Write the selection (times the mask, if used) to the mask layer.
  bool write_mask = false;

  static constexpr float kAnyValue = 20.0f;
  static constexpr int kByKey = -1;
};

/// Changes the color of surfaces: R' = R + w (R_target − R). Where the mask layer says what is
/// behind an object's edge (Role::mask), that share of a pixel stays. Shading stays, as does the
/// amount of light in layers of light (Layers::global); light that bounced off the recolored
/// surfaces takes their new color (LightEdit).
class Recolor {
 public:
  Recolor(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Records the edit of `layers`, which must have Role::intrinsic. Planes that others hold are not
  /// written: the edit goes to a new one. Does nothing if strength is 0 and no mask is to be
  /// written. Values that are not finite count as 0 (infinity: as 65504); `params` are clamped to
  /// their ranges.
  ///
  /// With a cluster or a base color, `layers` must have Role::model too: the palette is of that, so
  /// that an index means the same color in consecutive editors.
  void record(gpu::Commands& commands, Layers& layers, const RecolorParams& params);

  /// Forgets the clusters and the masks of earlier frames.
  void reset();

  /// The clusters in use; null before a cluster was selected.
  const Palette* palette() const { return palette_ ? &palette_->palette() : nullptr; }

 private:
  std::shared_ptr<gpu::Device> device_;
  PlanePool planes_;
  gpu::BufferPtr nothing_, no_bases_, base_color_, mask_color_;
  bool mask_seen_ = false;
  gpu::Program<shaders::edit_base_key> base_key_;
  gpu::Program<shaders::edit_mask_key> mask_key_;
  // By MATTE + 2 PUBLISH.
  std::array<gpu::Program<shaders::edit_recolor>, 4> by_key_;
  std::array<gpu::Program<shaders::edit_recolor_cluster>, 4> by_cluster_;
  std::array<gpu::Program<shaders::edit_recolor_base>, 4> by_base_;
  std::array<gpu::Program<shaders::edit_recolor_mask>, 4> by_mask_;
  std::optional<ScenePalette> palette_;  // made on first use
  std::optional<LightEdit> light_;       // made when light first has layers
};

}  // namespace inverse
