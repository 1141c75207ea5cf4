// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <string>
#include <vector>

#include "kernels/lightstage/program/light_program.hpp"
#include "kernels/network/graph.hpp"

namespace inverse {

/// The relighting network (training/olat): features of a frame, and two small layers evaluated per
/// light (light_head.glsl).
struct RelightModels {
  static constexpr uint32_t kPlanes = 16, kHarmonics = 8, kHidden = 24, kOut = 4;
  static constexpr uint32_t kStep = 32;  ///< widths and heights of images are multiples of this

  network::Graph features;   ///< 6 channels to 4 kPlanes, the same size
  std::vector<float> inner;  ///< kHidden x (kPlanes + kHarmonics)
  std::array<float, kHidden> inner_bias{};
  std::array<float, kOut * kHidden> outer{};  ///< kOut x kHidden
  std::array<float, kOut> outer_bias{};

  /// Loads features.net and light.net from a folder. Throws Error(file) with the file and, if
  /// numbers or sizes are wrong, the layer.
  static RelightModels load(const std::string& folder);
  /// The same from graphs; messages call the light network `name`.
  static RelightModels of(network::Graph features, const network::Graph& light,
                          const std::string& name);

  /// The light-dependent part of the hidden layer's input: Σ_m W_j,16+m φ_m(w) + b_j.
  std::array<float, kHidden> bias_for(const Direction& light) const;
  /// φ(w) = (x, y, z, xy, yz, zx, x² − y², 3z² − 1)
  static std::array<double, kHarmonics> harmonics(const Direction& light);
};

}  // namespace inverse
