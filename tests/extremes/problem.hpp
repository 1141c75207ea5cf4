// One linear system with everything that a table of conditions needs: what is solved, its exact
// solution, and how our solver does it.
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
};
inline constexpr Solver kSolvers[] = {Solver::multigrid, Solver::pcg, Solver::schwarz};
const char* name_of(Solver solver);

/// A x = b with a symmetric positive definite A whose entries a float holds exactly, or nearly.
struct Problem {
  std::string name;
  Solver solver;
  Dense matrix;
  std::vector<double> b;
  /// Solves it in single precision on the device, from zero, and returns x in the order of b.
  std::function<std::vector<double>(const Lab& lab)> solve_on_device;
};

/// What came of one.
struct Outcome {
  double condition = 0;                 ///< of A
  double condition_preconditioned = 0;  ///< of D^−1/2 A D^−1/2, D the diagonal of A
  double digits_plain = 0;              ///< kept by single precision without preconditioner
  double digits_preconditioned = 0;     ///< kept by the solver on the device
  bool finite = false;
};
Outcome judge(const Problem& problem, const Lab& lab);

/// The ladder: systems of conditions from 1e2 to 1e8 for every solver.
std::vector<Problem> ladder();

/// Largest loss that the condition number predicts: digits ≥ −log10(kLoss · condition · 2^−24).
/// The constant stands for the growth of rounding errors with the number of unknowns (400) and of
/// iterations.
inline constexpr double kLoss = 8;
double predicted_digits(double condition);

}  // namespace inverse::extremes
