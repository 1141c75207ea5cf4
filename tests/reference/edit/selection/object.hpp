// SPDX-License-Identifier: LGPL-2.1-or-later
// Selection of an object that a user points at, on a grid of cells. Double precision.
//
//   f        the Oklab color of a cell's mean reflectance
//   O, B     densities of color of the object and of the background: histograms of 10 x 24 x 24
//            bins, smoothed twice by (1/4, 1/2, 1/4) along each axis, of sum 1; at least those
//            under strokes that add, and that subtract, the largest since a selection was begun
//   c        min(|ln ((O + e) / (B + e))| / 3, 1), e = .002 max O: how certain a color is
//   p        c (O + e) / (O + B + 2 e) + (1 - c) region: how likely a cell is the object's
//   w        .05 c^2 + 1e-3
//   d_a, d_s shortest paths from strokes that add, and that subtract: a step to a neighbor costs
//            .005 + |f_i - f_j| / .04; eight passes along rows and columns
//   s        2 / (1 + exp((d_a - d_s) / .3)) - 1; 0 without strokes of both kinds
//   m, v     .05 |s| (1 - c)^2 and whether s > 0: what strokes decide where colors do not; under
//            strokes m = 10. A cell forgets them once its color is .08 from that when they were
//            drawn
//   alpha    minimum of sum w (alpha - p)^2 + m (alpha - v)^2
//              + sum 2 exp(-|f_i - f_j|^2 / (2 .04^2)) (alpha_i - alpha_j)^2
//            over cells and pairs of neighbors, by Jacobi steps from alpha + min((w + m) / .05, 1)
//            ((w p + m v) / (w + m) - alpha), alpha of the frame before
//   region   connected components of alpha > 1/2 of which the region of the frame before had a
//            tenth, or which have a stroke that adds
//
// Five rounds of this with the first strokes, one with others and in later frames. O is learned
// from alpha in the region; B from cells that are away from the region and whose color
// has at most .2 of the largest density of the object and of the strokes that add, since cells
// of these colors elsewhere may be other objects of the same paint. Colors that are in neither,
// e.g. paler petals of the same flower, or in both, go by their neighbors.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tests/reference/plane.hpp"

namespace inverse::reference {

/// Oklab (Ottosson 2020) of linear RGB.
Vec3 oklab(const Vec3& rgb);

/// The mean of each cell of side × side pixels; cells at the right and lower border may be smaller.
Plane cell_means(const Plane& plane, int side);

constexpr int kColorBins = 10 * 24 * 24;
int color_bin(const Vec3& oklab);
/// Smoothed histogram.
std::vector<double> smooth_histogram(const std::vector<double>& counts);

/// seed_around: around a closed stroke that adds; subtracts what is not selected yet.
enum Seed : uint32_t { no_seed, seed_add, seed_subtract, seed_around };

class ObjectSelection {
 public:
  ObjectSelection(int width, int height);  ///< in cells

  void select(const std::vector<Vec3>& colors, const std::vector<uint32_t>& seeds, bool restart);
  void follow(const std::vector<Vec3>& colors);
  /// The next frame is of another time: the object is found by its colors,
  /// and by strokes on what has kept its place and color.
  void lose();

  std::vector<double> alpha;
  std::vector<uint32_t> region;
  int area() const;

 private:
  /// What strokes say of a cell: s, 2 or -2 under them, and its color then.
  struct Memory {
    Vec3 color{};
    double s = 0;
  };
  /// Forgets strokes on what has moved away; returns those that are left, with the new ones.
  std::vector<uint32_t> marks(const std::vector<Vec3>& colors, const std::vector<uint32_t>& drawn);
  std::vector<double> distances(const std::vector<Vec3>& colors, const std::vector<uint32_t>& seeds,
                                Seed kind) const;
  void segment(const std::vector<Vec3>& colors, const std::vector<uint32_t>& seeds, int steps);
  void find_region(const std::vector<uint32_t>& seeds, bool seeded);
  void learn(const std::vector<Vec3>& colors, double rate);
  static void blend(std::vector<double>& density, const std::vector<double>& counts, double rate);
  std::vector<bool> near_region() const;

  int width_, height_, last_area_ = 0;
  bool active_ = false, lost_ = false;
  std::vector<double> object_, background_, added_, subtracted_;  // densities
  std::vector<double> p_, weight_;
  std::vector<Memory> memory_;
};

}  // namespace inverse::reference
