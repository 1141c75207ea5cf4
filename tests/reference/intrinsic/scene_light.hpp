// SPDX-License-Identifier: LGPL-2.1-or-later
// The slope of the color of a scene's light, in double precision: the specification of
// kernels/intrinsic/light_color (light.glsl).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace inverse::reference {

/// Points of a frame or means of 2 x 2 of them: mean log intensity m, b = ln R/B,
/// g = ln sqrt(R B)/G, and a weight that is low in the dark.
struct PointLevel {
  int width = 0, height = 0;
  std::vector<std::array<double, 4>> points;
  const std::array<double, 4>& at(int x, int y) const {
    return points[std::size_t(y) * std::size_t(width) + std::size_t(x)];
  }
};

class SceneLight {
 public:
  static constexpr int kPoints = 176, kLevels = 4;
  static constexpr int kTints = 3, kSizes = 10, kSlopes = 43, kCandidates = 29;
  static constexpr int kChannels = kLevels * kTints * kSizes;
  static constexpr int kCloudRows = 8, kCloudColumns = 20;
  enum class Did { measured, reused, no_color, no_contrast };
  struct State {
    double slope = 0, reference = 0, confidence = 0;  ///< in force
    double target = 0, spread = 0;                    ///< measured
    int measurements = 0;                             ///< since a cut
    Did did = Did::reused;
  };

  /// `weights`: of the network.
  explicit SceneLight(std::span<const float> weights) : weights_(weights.begin(), weights.end()) {}

  /// The next frame, interleaved linear RGB. `first`: it has no relation to the one before. `due`:
  /// the slope is measured, also if the scene is the same. `given`: the slope, not measured.
  const State& update(const double* rgb, int width, int height, bool first, bool due,
                      std::optional<double> given = {});

  /// The exposure of the frame changed: the next one has its white light there.
  void expose(double step) { exposure_ += step; }

  // The parts.
  /// Cells of `factor` pixels.
  static PointLevel points_of(const double* rgb, int width, int height, int factor);
  /// ln(1 + 2 c) of the counts c of steps, channel by channel.
  static std::vector<double> features_of(PointLevel level);
  static std::vector<double> cloud_of(const PointLevel& points, double bright);
  /// For each candidate.
  std::array<double, kCandidates> votes_of(const std::vector<double>& features,
                                           const std::vector<double>& cloud) const;
  static double candidate(int i) { return 0.1 * (i - kCandidates / 2); }

 private:
  void measure(const PointLevel& points, const std::vector<double>& cloud);

  std::vector<double> weights_;
  State state_;
  bool known_ = false;
  double exposure_ = 0;  ///< change that state_.reference has not taken
  std::vector<double> cloud_;
  std::array<double, kCandidates> votes_{};
};

}  // namespace inverse::reference
