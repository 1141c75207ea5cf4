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
/// ln chromaticity or given, refined, and each with an indirect layer where it needs one.
///
/// Refined colors are those of the light. What the reflectance is drawn to (r_cluster) stays the
/// color that was estimated: if it followed, each would chase the other and neither come to rest.
class BaseColors {
 public:
  static constexpr int kMaxColors = shaders::thesis_chapter5_setup_setup::kMaxColors;
  static_assert(kMaxColors == Palette::kMaxClusters);
  /// Channels are kept above this: reflectance of a black base color.
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

  /// Takes a new palette in: colors that it no longer has retire, new ones join, the others follow
  /// it until they are fixed. Does nothing if colors were given.
  void update(std::span<const Palette::Cluster> clusters, float tau_neutral);
  /// Uses these colors (linear, any scale), one layer each, until `reset`. At most kMaxColors.
  void set(std::span<const Rgb> colors);
  /// The palette moves the present colors no more: their refinement begins.
  void fix();
  /// b_k += Δb_k for the layers in their order, kept within kDarkest … 1; a channel that would
  /// not be finite stays as it is. Returns the largest change of a channel, 1 if one stayed.
  float refine(std::span<const Rgb> delta);
  /// The palette may move all colors again: of another scene.
  void loosen();
  /// Keeps the present colors whatever the palette finds, until `reset`.
  void hold() { given_ = true; }
  void reset();

  const std::vector<Color>& colors() const { return colors_; }
  int layers() const { return layers_; }
  /// One more than the highest slot in use.
  int slots() const { return colors_.empty() ? 0 : colors_.back().slot + 1; }
  bool given() const { return given_; }
  /// The colors of the layers, in their order; `initial`: before refinement.
  std::vector<Rgb> layer_colors(bool initial = false) const;
  /// Another number whenever the layers' colors or their order change.
  uint32_t version() const { return version_; }
  /// Another number whenever other colors have layers, or in another order.
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
