// SPDX-License-Identifier: LGPL-2.1-or-later
// The specification of kernels/intrinsic's multigrid: checkerboard blocks whose rows are solved
// exactly, piecewise constant corrections, cell terms on level 2. Double precision, no
// dependencies.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace inverse::reference::multigrid {

/// One level of A s = f: A(x,x) = mass + edges, A(x,y) = -right or -down. Planes of width x height;
/// edges live with the pixel on their left or upper end, 0 if the other end is outside.
struct Level {
  int width = 0, height = 0;
  std::vector<double> right, down, mass, f, s;
  // While relaxing: the pixels' shares of the cells' source term and screening, and s at the start
  // of the pass, about which the screening acts.
  std::vector<double> cell_source, cell_screening, at_start;

  Level() = default;
  Level(int w, int h);
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  double diagonal(int x, int y) const;
  double residual(int x, int y) const;
};

/// Exact solution of four pixels of a row, x from `first`, with everything else fixed.
void solve_row(Level& level, int first, int y);

/// Half a pass: blocks of 4 x `rows` pixels of one color of the checkerboard; rows downwards, then
/// upwards.
void smooth(Level& level, int color, int rows);

/// The next coarser operator: masses add up; edges across the aggregates' borders add up, in series
/// with the aggregates' inner edges, with at least the share `min_share`.
Level coarsen(const Level& fine, double min_share);

/// 2 x 2 means; the last row or column of an odd border counts twice.
std::vector<double> halve(const std::vector<double>& fine, int width, int height);

/// All levels down to a single pixel. `screening` is added to the masses of level 2.
std::vector<Level> hierarchy(const Level& finest, const std::vector<double>& screening,
                             double scale);

/// Cell terms within a cycle, as functions of the residual after the finer levels (`far`), the cell
/// means of s and the level of the cells.
struct CellTerms {
  /// Sets the right-hand side of level 2, before each of its V-cycles.
  std::function<void(const std::vector<double>& far, const std::vector<double>& means,
                     Level& cells)>
      before;
  /// The cells' source term after the last V-cycle.
  std::function<std::vector<double>(const std::vector<double>& means, const Level& cells)> after;
};

/// Packs of the levels that the kernels keep in shared memory.
inline constexpr std::size_t kMaxTogether = 512;

/// One cycle, as Multigrid::record_cycle without extrapolation; `screening` is the cells', `source`
/// is read and renewed. Levels of at most `together` packs, and of kMaxTogether with all coarser
/// ones, have blocks of single rows, and are smoothed before corrections from below, as levels 0
/// and 1 are.
void cycle(std::vector<Level>& levels, int cell_cycles, const CellTerms& terms,
           const std::vector<double>& screening, std::vector<double>& source,
           std::size_t together = 300);

/// Chebyshev's combination of cycles whose error factors lie between 0 and `slowest` (Varga, Matrix
/// Iterative Analysis, 5.1): call with the number of the cycle, from 0, and s before it.
class Extrapolation {
 public:
  explicit Extrapolation(double slowest) : slowest_(slowest) {}
  void apply(int k, const std::vector<double>& start, std::vector<double>& s);

 private:
  double slowest_, w_ = 1;
  std::vector<double> before_;
};

}  // namespace inverse::reference::multigrid
