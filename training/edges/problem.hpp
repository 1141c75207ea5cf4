// SPDX-License-Identifier: LGPL-2.1-or-later
// One frame's decomposition as a differentiable function of the edge prior: the energy of
// docs/reference/methods/intrinsicdecomp.md with the chroma bins solved jointly, and its adjoint.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "net.hpp"
#include "scenes.hpp"
#include "tests/bench/metrics/image.hpp"

namespace inverse::training {

/// Two pixels, and how much brighter the first one's reflectance is (difference of mean ln R).
struct Pair {
  std::size_t i, j;
  float step;
};

/// Weights of what the loss adds to errors of shading and reflectance.
struct LossWeights {
  double equal = 0, different = 0;  ///< Over pairs.
  double alike = 0;                 ///< How far ln R is from `other`, less the mean distance.
  const Plane* other = nullptr;  ///< Mean ln R found for the same scene in another light, or null.
};

/// A frame with truth, and everything that does not depend on the parameters.
struct Example {
  bench::Image input, reflectance, shading, mask;
  int width = 0, height = 0, cells_x = 0, cells_y = 0;
  Plane m;                               ///< Pixels.
  Plane cell_m, cell_value, cell_count;  ///< Cells: mean of m, m + u, pixels.
  std::vector<Plane> right, down, cell;  ///< Cues.
  std::vector<int> bin;                  ///< Cells: first of four bins.
  Plane bin_fraction;                    ///< Cells: two fractions each.

  std::vector<Pair> equal, different;  ///< Pixels of one paint and of two; see draw_pairs.

  int cell_of(int i) const { return i / width / 4 * cells_x + i % width / 4; }
};

/// Computes guide, cues and bins of a scene whose light the slope k is assumed to describe.
Example make_example(const Scene& scene, double k);

/// Draws up to 1500 pairs of pixels of equal reflectance (within .05 of ln in every channel), and
/// of different ones (mean ln apart by .15), that are not dark. Where the slope assumed is wrong,
/// the reflectance that belongs to it differs in and out of a shadow, and so there is no equal
/// pair.
void draw_pairs(Example& example);

/// The two networks in one parameter vector. Their last cue is the slope of light, min(|k|, 1): the
/// steeper it is, the surer an achromatic step is paint.
struct Model {
  Net edge, cell;
  Model(int edge_hidden, int cell_hidden);
  int count() const { return edge.count() + cell.count(); }
};

/// Solution and adjoint of one example; both are warm starts of the next visit.
struct Solution {
  Plane s, adjoint;
};

/// The seven planes of the prior: ln a and ln b of every right and lower edge; ln v, what V is
/// above the cell's value, and ln g of every cell. Weights are clamped, and those of cells times
/// their area, when they are used.
struct Prior {
  std::array<Plane, 2> right, down;
  std::array<Plane, 3> cell;
};

/// Of a pixel or cell of mean log intensity m in errors of logarithms: 1 where it is bright.
double brightness_weight(float m);

/// Weighted mean of a pseudo-Huber distance of `off` less its mean, times `factor`; linear beyond
/// `near`. Its derivative by `off` is added to `gradient`.
double distance_from_mean(const Plane& weight, const Plane& off, double near, double factor,
                          Plane& gradient);

/// Windowed scale-invariant error of reflectance and shading (k = 20, k = 60, whole frame), which
/// is LMSE at three scales, plus the error of log shading, plus weighted errors over pairs: the
/// mean |step of ln R| of equal ones, and what different ones lack, as WHDR judges, plus that of
/// LossWeights::alike; `gradient` receives its derivative by s.
double loss(const Example& example, const Plane& s, Plane& gradient,
            const LossWeights& weights = {});

/// A loss of s, whose derivative it writes to the second plane.
using LossOfShading = std::function<double(const Plane&, Plane&)>;

/// Solves one example with this prior and returns the loss; `gradient`, if given, receives its
/// derivative by the prior's planes (implicit differentiation).
double evaluate(const Example& example, const Prior& prior, Solution& solution, Prior* gradient,
                const LossOfShading& loss_of);
double evaluate(const Example& example, const Prior& prior, Solution& solution, Prior* gradient,
                const LossWeights& weights = {});

/// The fitted prior of an example.
Prior fitted_prior(const Model& model, const std::vector<float>& parameters,
                   const Example& example);

/// The same as `evaluate` with the fitted prior; adds the gradient by its parameters when
/// `gradient` is given.
double evaluate(const Model& model, const std::vector<float>& parameters, const Example& example,
                Solution& solution, std::vector<double>* gradient, const LossOfShading& loss_of);
double evaluate(const Model& model, const std::vector<float>& parameters, const Example& example,
                Solution& solution, std::vector<double>* gradient, const LossWeights& weights = {});

}  // namespace inverse::training
