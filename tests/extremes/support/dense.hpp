// SPDX-License-Identifier: LGPL-2.1-or-later
// Symmetric systems of small size: spectrum, exact solution, and solution in single precision
// without preconditioner.
#pragma once
#include <cstddef>
#include <vector>

namespace inverse::extremes {

/// A symmetric n × n matrix in double precision, row by row.
class Dense {
 public:
  explicit Dense(size_t n) : n_(n), values_(n * n, 0.0) {}
  size_t size() const { return n_; }
  double& at(size_t row, size_t column) { return values_[row * n_ + column]; }
  double at(size_t row, size_t column) const { return values_[row * n_ + column]; }
  const double* data() const { return values_.data(); }

 private:
  size_t n_;
  std::vector<double> values_;
};

/// All eigenvalues, ascending.
std::vector<double> eigenvalues(const Dense& matrix);

/// Largest over smallest eigenvalue of a positive definite matrix; else infinity.
double condition_number(const Dense& matrix);

/// D^−1/2 A D^−1/2 with D the diagonal: A with Jacobi's preconditioner.
Dense scaled_by_diagonal(const Dense& matrix);

/// The solution of A x = b by Cholesky's factorization in extended precision. Throws
/// std::domain_error if A is not positive definite.
std::vector<double> solve(const Dense& matrix, const std::vector<double>& b);

/// At most `iterations` steps of conjugate gradients without preconditioner from 0, everything in
/// single precision; the residual is recomputed every 50 steps. Gives the iterate of least
/// residual.
std::vector<double> plain_single_precision(const Dense& matrix, const std::vector<double>& b,
                                           int iterations);

/// −log10 of |x − exact| / |exact| (Euclidean norms), between 0 (nothing is right, or not finite)
/// and 16.
double digits_kept(const std::vector<double>& x, const std::vector<double>& exact);

}  // namespace inverse::extremes
