// SPDX-License-Identifier: LGPL-2.1-or-later
#include "refinement.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "base_colors.hpp"

namespace inverse {
namespace {

double mean(const Eigen::Vector3d& color) {
  return std::max(color.mean(), static_cast<double>(BaseColors::kDarkest));
}

Eigen::Vector3d vector(const std::array<float, 3>& color) {
  return Eigen::Vector3f(color.data()).cast<double>();
}

}  // namespace

std::vector<std::array<float, 3>> solve_refinement(std::span<const float> sums,
                                                   std::span<const std::array<float, 3>> colors,
                                                   std::span<const std::array<float, 3>> initial,
                                                   double lambda_data, double lambda_ir,
                                                   double lambda_cr) {
  const auto count = static_cast<Eigen::Index>(colors.size());
  if (count == 0) return {};
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(3 * count, 3 * count);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(3 * count);
  const auto entry = [&](Eigen::Index k, Eigen::Index l, Eigen::Index c) {
    return lambda_data * static_cast<double>(sums[static_cast<size_t>(4 * (k + count * l) + c)]);
  };
  for (Eigen::Index k = 0; k < count; ++k) {
    for (Eigen::Index c = 0; c < 3; ++c) {
      b(3 * k + c) = entry(k, count, c);
      for (Eigen::Index l = 0; l <= k; ++l) {
        matrix(3 * k + c, 3 * l + c) = entry(k, l, c);
        matrix(3 * l + c, 3 * k + c) = entry(k, l, c);
      }
    }
    const Eigen::Vector3d color = vector(colors[static_cast<size_t>(k)]);
    const Eigen::Vector3d before = vector(initial[static_cast<size_t>(k)]);
    const Eigen::Vector3d chromaticity = color / mean(color);
    // ∂C/∂b of C = b/|b|, |b| the mean.
    const Eigen::Matrix3d slope =
        (Eigen::Matrix3d::Identity() - chromaticity * Eigen::RowVector3d::Constant(1.0 / 3)) /
        mean(color);
    matrix.block<3, 3>(3 * k, 3 * k) +=
        lambda_ir * Eigen::Matrix3d::Identity() + lambda_cr * slope.transpose() * slope;
    b.segment<3>(3 * k) -= lambda_cr * slope.transpose() * (chromaticity - before / mean(before));
  }
  Eigen::JacobiSVD<Eigen::MatrixXd, Eigen::NoQRPreconditioner> svd(
      matrix, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(1e-9);
  const Eigen::VectorXd delta = svd.solve(b);
  std::vector<std::array<float, 3>> result(colors.size());
  for (size_t k = 0; k < colors.size(); ++k) {
    for (size_t c = 0; c < 3; ++c)
      result[k][c] = static_cast<float>(delta(static_cast<Eigen::Index>(3 * k + c)));
  }
  return result;
}

}  // namespace inverse
