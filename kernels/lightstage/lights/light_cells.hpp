// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/environment/environment.hpp"
#include "kernels/lightstage/program/light_program.hpp"

namespace inverse {

using Rgb = std::array<float, 3>;

/// A light that lights a relit subject: direction, and brightness relative to a light of the stage.
struct WeightedLight {
  Direction direction{};
  Rgb weight{};
};

/// The median angle between a light and its nearest neighbor, radian; π for a single light.
double light_spacing(std::span<const Direction> lights);

/// Divides the sphere among the lights of a stage: each direction belongs to the nearest light,
/// unless that is farther than 1.5 times the spacing. Light from directions without lights (the
/// floor) cannot be reproduced and is dropped.
class LightCells {
 public:
  explicit LightCells(std::vector<Direction> lights);

  const std::vector<Direction>& lights() const { return lights_; }
  /// Solid angle of all cells, steradian.
  double covered() const { return covered_; }

  /// An environment prepared for rotation.
  struct Map {
    std::vector<float> flux;  ///< kRows x 2 kRows x RGB: ∫ E dw of each patch
  };
  static Map map(const Environment& environment);

  /// Weight of each light so that all together light the subject as the environment does (Debevec
  /// et al. 2000): w_i = N / covered() ∫ E dw over its cell. Uniform white radiance 1 gives Σ w_i =
  /// N: the stage with all lights on. `rotation` turns the environment about y, radian: light from
  /// +z then comes from +x.
  std::vector<Rgb> weights(const Map& map, double rotation = 0) const;

  /// Share of an environment's light that falls into cells, by the sum of its channels; 1 if it is
  /// dark.
  static double shown(const Map& map, std::span<const Rgb> weights, double covered);

  static constexpr uint32_t kRows = 256;  ///< of the patches that are shared out

 private:
  static constexpr uint16_t kNone = 0xffff;
  std::vector<Direction> lights_;
  std::vector<uint16_t> owner_;  // of each patch
  double covered_ = 0;
};

}  // namespace inverse
