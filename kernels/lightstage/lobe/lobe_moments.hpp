// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/lightstage/program/light_program.hpp"
#include "kernels/lightstage_lobe_lobes.spv.hpp"

namespace inverse {

/// Correction of the equations of the cosine lobe (lobe.glsl), which assume light from all
/// directions, for the lights of a stage: with few lights, or none at the floor, the mean direction
/// from two gradients differs from that of the lobe.
///
/// For the lobe of direction u and exponent p, v = u (p + 1)/(p + 2) is the mean direction under
/// uniform light and M(v) = Σ w_i max(0, u·w_i)^p / Σ max(0, u·w_i)^p under the stage's lights.
/// For |v| < 1/2 both include uniform light. A table over M holds v − M, from which a pixel gets v.
class LobeMoments {
 public:
  static constexpr uint32_t kGrid = 21;  ///< points of the table along each axis, M from −1 to 1
  static constexpr double kLargestExponent = shaders::lightstage_lobe_lobes::kLargestExponent;

  explicit LobeMoments(std::span<const Direction> lights);

  /// The largest exponent that lights of this spacing can resolve: lobes at least as wide as half
  /// the spacing, 1/√p ≥ spacing / 2. From 1 to kLargestExponent.
  double largest_exponent() const { return largest_exponent_; }
  /// M for a mean direction v under uniform light.
  Direction seen(const Direction& v) const;
  /// v for a measured mean direction, by iteration from `guess`.
  Direction even(const Direction& seen, const Direction& guess) const;

  using Vec4 = std::array<float, 4>;
  /// v − M, kGrid³ values, x fastest.
  const std::vector<Vec4>& table() const { return table_; }

 private:
  std::vector<Direction> lights_;
  Direction mean_{};  // of all lights
  double largest_exponent_;
  std::vector<Vec4> table_;
};

}  // namespace inverse
