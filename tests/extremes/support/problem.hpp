// SPDX-License-Identifier: LGPL-2.1-or-later
// A linear system for the table of conditions: matrix, exact solution, and the project's solver.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "dense.hpp"
#include "lab.hpp"

namespace inverse::extremes {

enum class Solver : uint8_t {
  multigrid,  ///< intrinsicdecomp's
  pcg,        ///< of intrinsicdecompthesis
  schwarz,    ///< of intrinsicdecompthesis
  global,     ///< globalintrinsic's: what it finds around a solve by multigrid
  global_thesis,
};
/// Solvers of one system per frame.
inline constexpr Solver kSolvers[] = {Solver::multigrid, Solver::pcg, Solver::schwarz};
/// Methods that find direct and indirect light as well (global_methods.hpp).
inline constexpr Solver kGlobalMethods[] = {Solver::global, Solver::global_thesis};
const char* name_of(Solver solver);

/// A x = b with a symmetric positive definite A whose entries a float holds exactly, or nearly.
struct Problem {
  std::string name;
  Solver solver;
  Dense matrix;
  std::vector<double> b;
  /// Solves it in single precision on the device, from zero, and returns x in the order of b.
  std::function<std::vector<double>(const Lab& lab)> solve_on_device;
  int iterations = 0;  ///< that this takes: cycles, or steps of conjugate gradients
};

/// Results for one system.
struct Outcome {
  double condition = 0;                 ///< of A
  double condition_preconditioned = 0;  ///< of D^−1/2 A D^−1/2, D the diagonal of A
  double digits_plain = 0;              ///< reached in single precision without preconditioner
  double digits_preconditioned = 0;     ///< reached by the solver on the device
  bool finite = false;
};
Outcome judge(const Problem& problem, const Lab& lab);

/// Systems of conditions from 1e2 to 1e8 for every solver.
std::vector<Problem> stiff_problems();

/// The min digits that the outcome must reach: the condition number predicts a relative error
/// of C · condition · 2^−24. Conjugate gradients: the condition after scaling by the diagonal, C
/// = 4. Multigrid: the condition of A, which it does not scale, C = 32; what of that it loses it
/// has not reached yet, rather than lost to rounding. Negative where nothing is predicted.
double predicted_digits(Solver solver, const Outcome& outcome);

}  // namespace inverse::extremes
