// SPDX-License-Identifier: LGPL-2.1-or-later
#include "measured_light.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace inverse {
namespace {

constexpr double kPower = 1.4;         // of the rest, that is made small
constexpr double kNear = 0.02;         // of the mean weight: closer than that is no better
constexpr int kSteps = 20;             // of reweighting
constexpr double kOtherChannel = 0.7;  // in components that another channel has measured
constexpr double kNothing = 1e-2;      // of the mean weight
constexpr double kRidge = 1e-9;        // keeps the system regular if all lights lie in a plane

/// The plane through the weights of one channel: even, and by component.
Eigen::Vector4d fit(std::span<const Direction> lights, const std::vector<double>& weights) {
  double mean = 0;
  for (const double w : weights) mean += std::fabs(w) / static_cast<double>(weights.size());
  Eigen::Vector4d plane = Eigen::Vector4d::Zero();
  if (!(mean > 0)) return plane;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix4d products = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (size_t i = 0; i < lights.size(); ++i) {
      const Eigen::Vector4d x(1, lights[i][0], lights[i][1], lights[i][2]);
      const double away = std::max(std::fabs(weights[i] - plane.dot(x)) / mean, kNear);
      const double weight = step == 0 ? 1 : std::pow(away, kPower - 2);
      products += weight * x * x.transpose();
      right += weight * weights[i] * x;
    }
    products.diagonal().array() += kRidge * products.trace();
    plane = products.ldlt().solve(right);
  }
  // A few bright lights in the dark: the measured part is negligible, and dark lights would have to
  // be evaluated.
  if (plane.cwiseAbs().maxCoeff() < kNothing * mean) plane.setZero();
  return plane;
}

}  // namespace

SplitLight SplitLight::of(std::span<const Direction> lights, std::span<const Rgb> weights) {
  SplitLight split{{}, {weights.begin(), weights.end()}};
  std::vector<double> channel(lights.size());
  for (size_t c = 0; c < 3; ++c) {
    for (size_t i = 0; i < lights.size(); ++i) channel[i] = weights[i][c];
    Eigen::Vector4d plane = fit(lights, channel);
    for (size_t k = 0; k < 3; ++k) {
      if (k != c) plane[static_cast<int>(k) + 1] *= kOtherChannel;
      split.measured.along[k][c] = static_cast<float>(plane[static_cast<int>(k) + 1]);
    }
    split.measured.even[c] = static_cast<float>(plane[0]);
    for (size_t i = 0; i < lights.size(); ++i)
      split.rest[i][c] = static_cast<float>(
          channel[i] - plane.dot(Eigen::Vector4d(1, lights[i][0], lights[i][1], lights[i][2])));
  }
  return split;
}

}  // namespace inverse
