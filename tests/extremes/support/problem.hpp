// SPDX-License-Identifier: LGPL-2.1-or-later
// A linear system for the table of conditions: matrix, exact solution, and the project's solver.
#pragma once
#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "dense.hpp"
#include "tests/lab.hpp"

namespace inverse::extremes {

enum class Solver : uint8_t {
  multigrid,  ///< intrinsicdecomp's
  pcg,        ///< of intrinsicdecompthesis
  schwarz,    ///< of intrinsicdecompthesis
  global,     ///< globalintrinsic's: what it finds around a solve by multigrid
  global_thesis,
};
inline constexpr Solver kSolvers[] = {Solver::multigrid, Solver::pcg, Solver::schwarz,
                                      Solver::global, Solver::global_thesis};
/// Whether it finds direct and indirect light as well.
inline bool is_global(Solver solver) { return solver >= Solver::global; }
inline constexpr Solver kGlobalSolvers[] = {Solver::global, Solver::global_thesis};
const char* name_of(Solver solver);
/// Names the tests of a solver.
inline constexpr auto solver_name = [](const auto& info) {
  std::string name = name_of(info.param);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
};

/// A x = b with a symmetric positive definite A whose entries a float holds exactly, or nearly.
struct Problem {
  std::string name;
  Solver solver;
  Eigen::MatrixXd matrix;
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

/// A number in the name of a system.
std::string decade(double value);

/// Systems of conditions from 1e2 to 1e8 for every solver.
std::vector<Problem> stiff_problems();

}  // namespace inverse::extremes
