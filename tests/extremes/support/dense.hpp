// SPDX-License-Identifier: LGPL-2.1-or-later
// Symmetric systems of small size: spectrum, exact solution, and solution in single precision
// without preconditioner.
#pragma once
#include <Eigen/Core>
#include <vector>

namespace inverse::extremes {

/// All eigenvalues, ascending.
std::vector<double> eigenvalues(const Eigen::MatrixXd& matrix);

/// Largest over smallest eigenvalue of a positive definite matrix; else infinity.
double condition_number(const Eigen::MatrixXd& matrix);

/// D^−1/2 A D^−1/2 with D the diagonal: A with Jacobi's preconditioner.
Eigen::MatrixXd scaled_by_diagonal(const Eigen::MatrixXd& matrix);

/// The solution of A x = b by Cholesky's factorization in extended precision. Throws
/// std::domain_error if A is not positive definite.
std::vector<double> solve(const Eigen::MatrixXd& matrix, const std::vector<double>& b);

/// At most `iterations` steps of conjugate gradients without preconditioner from 0, everything in
/// single precision; the residual is recomputed every 50 steps. Gives the iterate of least
/// residual.
std::vector<double> plain_single_precision(const Eigen::MatrixXd& matrix,
                                           const std::vector<double>& b, int iterations);

/// −log10 of |x − exact| / |exact| (Euclidean norms), between 0 (nothing is right, or not finite)
/// and 16.
double digits_kept(const std::vector<double>& x, const std::vector<double>& exact);

}  // namespace inverse::extremes
