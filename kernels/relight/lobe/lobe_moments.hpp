#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "stage/program/light_program.hpp"

namespace inverse {

/// What the lights of a stage make of the equations of the cosine lobe (lobe.glsl), which are of
/// light from everywhere: with few lights, or none where the floor is, the mean direction that two
/// gradients show is not that of the lobe.
///
/// For the lobe of direction u and exponent p, v = u (p + 1)/(p + 2) is the mean direction under
/// even light and M(v) = Σ w_i max(0, u·w_i)^p / Σ max(0, u·w_i)^p under the stage's; below
/// |v| = 1/2 both are mixed with light from everywhere. A table over M holds v − M, so that a pixel
/// finds its v with one look.
class LobeMoments {
 public:
  static constexpr uint32_t kGrid = 21;  ///< points of the table along each axis, M from −1 to 1
  static constexpr double kLargestExponent = 63;

  explicit LobeMoments(std::span<const Direction> lights);

  /// The largest exponent that lights so far apart can tell: lobes are to be as wide as half of
  /// their spacing, 1/√p ≥ spacing / 2. From 1 to kLargestExponent.
  double largest_exponent() const { return largest_exponent_; }
  /// M of an even mean direction v.
  Direction seen(const Direction& v) const;
  /// v of a mean direction that was seen, by iteration, starting from `guess`.
  Direction even(const Direction& seen, const Direction& guess) const;

  using Vec4 = std::array<float, 4>;
  /// v − M, kGrid³ of them, x fastest.
  const std::vector<Vec4>& table() const { return table_; }

 private:
  std::vector<Direction> lights_;
  Direction mean_{};  // of all lights
  double largest_exponent_;
  std::vector<Vec4> table_;
};

}  // namespace inverse
