// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/palette/palette.hpp"
#include "kernels/thesis_chapter5_setup_setup.spv.hpp"

namespace inverse {

/// The base colors b_1 … b_K of a video (thesis, 5.5.1) on the host: found by the palette in
/// ln chromaticity or given, refined, and each with an indirect layer if it needs one.
///
/// Refinement changes the colors of the light only. The target of the reflectance (r_cluster) stays
/// the estimated color: if it followed, the two would not converge.
class BaseColors {
 public:
  static constexpr int kMaxColors = shaders::thesis_chapter5_setup_setup::kMaxColors;
  static_assert(kMaxColors == Palette::kMaxClusters);
  /// Minimum of a channel: reflectance of a black base color.
  static constexpr float kDarkest = 1e-3f;
  using Rgb = std::array<float, 3>;

  struct Color {
    int slot;     ///< of the palette; stays from frame to frame
    Rgb center;   ///< ln chromaticity that pixels are assigned by
    Rgb color;    ///< b, largest channel 1 before refinement
    Rgb initial;  ///< b before refinement
    bool fixed;   ///< refined or being refined: a change of the palette leaves it alone
    int layer;    ///< its indirect layer, from 0, or −1
  };

  /// Follows a new palette: adds its new colors, removes those it no longer has, and moves the
  /// others unless they are fixed. Does nothing if colors were given.
  void update(std::span<const Palette::Cluster> clusters, float tau_neutral);
  /// Uses these colors (linear, any scale), one layer each, until `reset`. At most kMaxColors.
  void set(std::span<const Rgb> colors);
  /// `update` no longer moves the present colors: their refinement begins.
  void fix();
  /// b_k += Δb_k for the layers in order, clamped to kDarkest … 1. A channel whose change is not
  /// finite stays unchanged. Returns the largest change of a channel, 1 if one was not finite.
  float refine(std::span<const Rgb> delta);
  /// `update` moves all colors again: they are of another scene.
  void loosen();
  /// Keeps the present colors until `reset`, as if they were given.
  void hold() { given_ = true; }
  void reset();

  const std::vector<Color>& colors() const { return colors_; }
  int layers() const { return layers_; }
  /// One more than the highest slot in use.
  int slots() const { return colors_.empty() ? 0 : colors_.back().slot + 1; }
  bool given() const { return given_; }
  /// The colors of the layers, in their order; `initial`: before refinement.
  std::vector<Rgb> layer_colors(bool initial = false) const;
  /// Changes with every change of the layers' colors or their order.
  uint32_t version() const { return version_; }
  /// Changes with every change of which colors have layers, or of their order.
  uint32_t order() const { return order_; }

  /// Fills the kernels' table (table.glsl): 3 · kMaxColors vec4.
  static constexpr uint64_t kTableEntries = 3 * kMaxColors;
  void write_table(float* table) const;

 private:
  void assign_layers(float tau_neutral);

  std::vector<Color> colors_;
  int layers_ = 0;
  bool given_ = false;
  uint32_t version_ = 0, order_ = 0;
};

}  // namespace inverse
