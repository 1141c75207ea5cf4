#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/environment/environment.hpp"
#include "stage/program/light_program.hpp"

namespace inverse {

using Rgb = std::array<float, 3>;

/// A light that lights a relit subject: where it is, and how bright in lights of the stage.
struct WeightedLight {
  Direction direction{};
  Rgb weight{};
};

/// The angle from most lights to their nearest neighbor (the median), radian; π for a single one.
double light_spacing(std::span<const Direction> lights);

/// Shares the sphere out among the lights of a stage: each direction belongs to the nearest light,
/// unless that is farther than 1.5 times the spacing: light from where a stage has none (its floor)
/// cannot be shown and is left out.
class LightCells {
 public:
  explicit LightCells(std::vector<Direction> lights);

  const std::vector<Direction>& lights() const { return lights_; }
  /// Solid angle of all cells together, steradian.
  double covered() const { return covered_; }

  /// An environment, ready to be turned.
  struct Map {
    std::vector<float> flux;  ///< kRows x 2 kRows x RGB: ∫ E dw of each patch
  };
  static Map map(const Environment& environment);

  /// How bright each light of the stage has to be so that all of them light the subject as the
  /// environment does (Debevec et al. 2000): w_i = N / covered() ∫ E dw over its cell. White
  /// radiance 1 from everywhere gives Σ w_i = N: the stage with all its lights on. `rotation` turns
  /// the environment about y, radian: what came from +z then comes from +x.
  std::vector<Rgb> weights(const Map& map, double rotation = 0) const;

  /// Of an environment's light, the share that falls into cells, by the sum of its channels; 1
  /// where it is dark.
  static double shown(const Map& map, std::span<const Rgb> weights, double covered);

  static constexpr uint32_t kRows = 256;  ///< of the patches that are shared out

 private:
  static constexpr uint16_t kNobody = 0xffff;
  std::vector<Direction> lights_;
  std::vector<uint16_t> owner_;  // of each patch
  double covered_ = 0;
};

}  // namespace inverse
