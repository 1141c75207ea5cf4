// SPDX-License-Identifier: LGPL-2.1-or-later
#include "dense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace inverse::extremes {
namespace {

Eigen::VectorXd::ConstMapType mapped(const std::vector<double>& vector) {
  return {vector.data(), static_cast<Eigen::Index>(vector.size())};
}

}  // namespace

std::vector<double> eigenvalues(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix, Eigen::EigenvaluesOnly);
  if (solver.info() != Eigen::Success) throw std::runtime_error("the eigenvalues do not converge");
  return {solver.eigenvalues().begin(), solver.eigenvalues().end()};
}

double condition_number(const Eigen::MatrixXd& matrix) {
  const std::vector<double> values = eigenvalues(matrix);
  return values.front() > 0 ? values.back() / values.front()
                            : std::numeric_limits<double>::infinity();
}

Eigen::MatrixXd scaled_by_diagonal(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * matrix * scale.asDiagonal();
}

std::vector<double> solve(const Eigen::MatrixXd& matrix, const std::vector<double>& b) {
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Eigen::LLT<Matrix> factor(matrix.cast<long double>());
  const Eigen::VectorXd x = factor.solve(mapped(b).cast<long double>()).cast<double>();
  if (factor.info() != Eigen::Success || !x.allFinite())
    throw std::domain_error("the matrix is not positive definite");
  return {x.begin(), x.end()};
}

std::vector<double> plain_single_precision(const Eigen::MatrixXd& matrix,
                                           const std::vector<double>& b, int iterations) {
  const Eigen::SparseMatrix<float, Eigen::RowMajor> a = matrix.cast<float>().sparseView();
  const Eigen::VectorXf right = mapped(b).cast<float>();
  Eigen::VectorXf x = Eigen::VectorXf::Zero(right.size()), best = x;
  Eigen::VectorXf residual = right, direction = right;
  float rr = residual.squaredNorm(), smallest = rr;
  for (int k = 0; k < iterations; ++k) {
    const Eigen::VectorXf product = a * direction;
    const float curvature = direction.dot(product);
    if (!(curvature > 0) || !(rr > 0)) break;
    const float alpha = rr / curvature;
    x += alpha * direction;
    const bool anew = k % 50 == 49;
    if (anew)
      residual = right - a * x;
    else
      residual -= alpha * product;
    const float next = residual.squaredNorm();
    if (next < smallest) {
      smallest = next;
      best = x;
    }
    direction = anew ? residual : Eigen::VectorXf(residual + next / rr * direction);
    rr = next;
  }
  return {best.begin(), best.end()};
}

double digits_kept(const std::vector<double>& x, const std::vector<double>& exact) {
  const double apart = (mapped(x) - mapped(exact)).squaredNorm();
  if (!std::isfinite(apart)) return 0;
  if (apart == 0) return 16;
  return std::clamp(-0.5 * std::log10(apart / mapped(exact).squaredNorm()), 0.0, 16.0) +
         0.0;  // not −0
}

}  // namespace inverse::extremes
