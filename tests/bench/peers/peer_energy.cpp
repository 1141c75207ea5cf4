// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicdecomp's energy (tests/reference/intrinsic/intrinsic_decomposition.hpp) for a single
// frame, minimized the way one would without a GPU: sparse matrix, double precision, Eigen. Two
// solvers: conjugate gradients with an inverse diagonal, and conjugate gradients whose
// preconditioner is the sparse Cholesky factor of everything but the chroma bins (which couple the
// whole frame).
#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>

#include "peers.hpp"
#include "tests/reference/intrinsic/intrinsic_decomposition.hpp"

namespace inverse::bench {
namespace {

using Eigen::VectorXd;
using Matrix = Eigen::SparseMatrix<double>;

/// Weights of the pixels along one axis in the cells' means: nested 2 x 2 means; the last pixel of
/// an odd border counts twice.
std::vector<double> shares(int count) {
  const int halves = (count + 1) / 2, cells = (halves + 1) / 2;
  std::vector<double> share(std::size_t(count), 0.0);
  for (int cell = 0; cell < cells; ++cell)
    for (const int half : {2 * cell, std::min(2 * cell + 1, halves - 1)})
      for (const int pixel : {2 * half, std::min(2 * half + 1, count - 1)})
        share[std::size_t(pixel)] += 0.25;
  return share;
}

/// E(s) = ½ sᵀ A s - bᵀ s, A = sparse - Mᵀ g B M: M takes cell means, B is splat and slice.
class Energy {
 public:
  Energy(const std::vector<double>& rgb, int width, int height)
      : guide_(reference::make_guide(rgb.data(), width, height)),
        prior_(reference::edge_prior(guide_, {})),
        cells_(guide_.level[reference::kCellLevel]) {
    const reference::GuideLevel& l = guide_.level[0];
    const std::size_t n = l.m.size(), w = std::size_t(width);
    const std::vector<double> across = shares(width), down = shares(height);
    cell_of_.resize(n), share_.resize(n);
    std::vector<std::vector<std::size_t>> members(cells_.m.size());
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const std::size_t i = l.index(x, y);
        cell_of_[i] = cells_.index(x >> reference::kCellLevel, y >> reference::kCellLevel);
        share_[i] = across[std::size_t(x)] * down[std::size_t(y)];
        members[cell_of_[i]].push_back(i);
      }
    b = VectorXd::Zero(Eigen::Index(n));
    start = b;
    std::vector<Eigen::Triplet<double>> entries;
    const auto edge = [&](std::size_t i, std::size_t j, double reflectance, double shading) {
      const double weight = reflectance + shading, step = reflectance * (l.m[i] - l.m[j]);
      const int p = int(i), q = int(j);
      entries.emplace_back(p, p, weight), entries.emplace_back(q, q, weight);
      entries.emplace_back(p, q, -weight), entries.emplace_back(q, p, -weight);
      b[p] += step, b[q] -= step;
    };
    for (std::size_t i = 0; i < n; ++i) {
      entries.emplace_back(int(i), int(i), reference::kMinDiagonal);
      if (i % w + 1 < w) edge(i, i + 1, prior_.a_right[i], prior_.b_right[i]);
      if (i + w < n) edge(i, i + w, prior_.a_down[i], prior_.b_down[i]);
    }
    std::vector<double> wanted(cells_.m.size());
    const std::vector<double> bins = through_bins(cells_.m);
    for (std::size_t c = 0; c < members.size(); ++c) {
      const double screen = prior_.v[c] + prior_.g[c];
      wanted[c] = prior_.v[c] * prior_.V[c] + prior_.g[c] * (cells_.m[c] - bins[c]);
      for (const std::size_t i : members[c]) {
        b[Eigen::Index(i)] += share_[i] * wanted[c];
        start[Eigen::Index(i)] = prior_.V[c] + l.m[i] + l.u[i] - cells_.m[c] - cells_.u[c];
        for (const std::size_t j : members[c])
          entries.emplace_back(int(i), int(j), screen * share_[i] * share_[j]);
      }
    }
    sparse.resize(Eigen::Index(n), Eigen::Index(n));
    sparse.setFromTriplets(entries.begin(), entries.end());
  }

  VectorXd apply(const VectorXd& s) const {
    std::vector<double> means(cells_.m.size(), 0.0);
    for (std::size_t i = 0; i < cell_of_.size(); ++i)
      means[cell_of_[i]] += share_[i] * s[Eigen::Index(i)];
    const std::vector<double> bins = through_bins(means);
    VectorXd out = sparse * s;
    for (std::size_t i = 0; i < cell_of_.size(); ++i)
      out[Eigen::Index(i)] -= share_[i] * prior_.g[cell_of_[i]] * bins[cell_of_[i]];
    return out;
  }

  Matrix sparse;
  VectorXd b, start;

 private:
  std::vector<double> through_bins(const std::vector<double>& values) const {
    const reference::ChromaBins bins = reference::splat_bins(cells_, prior_.g, values);
    std::vector<double> out(values.size());
    for (std::size_t c = 0; c < values.size(); ++c)
      out[c] = reference::slice_bins(bins, cells_.c0[c], cells_.c1[c]);
    return out;
  }

  reference::Guide guide_;
  reference::EdgePrior prior_;
  const reference::GuideLevel& cells_;
  std::vector<std::size_t> cell_of_;
  std::vector<double> share_;
};

/// Conjugate gradients until the residual is `tolerance` of the right-hand side's norm.
VectorXd solve(const Energy& energy, const std::function<VectorXd(const VectorXd&)>& precondition,
               double tolerance) {
  constexpr int kMaxIterations = 5000;
  VectorXd x = energy.start, r = energy.b - energy.apply(x), z = precondition(r), p = z;
  double rz = r.dot(z);
  const double enough = tolerance * energy.b.norm();
  for (int k = 0; k < kMaxIterations && r.norm() > enough; ++k) {
    const VectorXd q = energy.apply(p);
    const double alpha = rz / p.dot(q);
    x += alpha * p;
    r -= alpha * q;
    z = precondition(r);
    const double next = r.dot(z);
    p = z + (next / rz) * p;
    rz = next;
  }
  return x;
}

Decomposition decompose(const Image& input, bool cholesky, double tolerance) {
  const std::vector<double> rgb(input.data.begin(), input.data.end());
  const Energy energy(rgb, input.width, input.height);
  VectorXd s;
  if (cholesky) {
    const Eigen::SimplicialLDLT<Matrix> factor(energy.sparse);
    if (factor.info() != Eigen::Success) throw std::runtime_error("factorization failed");
    s = solve(
        energy, [&](const VectorXd& r) -> VectorXd { return factor.solve(r); }, tolerance);
  } else {
    const VectorXd inverse = energy.sparse.diagonal().cwiseInverse();
    s = solve(
        energy, [&](const VectorXd& r) -> VectorXd { return r.cwiseProduct(inverse); }, tolerance);
  }
  Image shading(input.width, input.height, 1);
  for (std::size_t i = 0; i < shading.data.size(); ++i)
    shading.data[i] = float(std::exp(s[Eigen::Index(i)]));
  return divide(input, std::move(shading));
}

Method method_of(const char* name, const char* description, bool cholesky,
                 std::initializer_list<std::pair<const char*, double>> tolerances) {
  Method method{name, "peer", description, {}, {}, "intrinsicdecomp"};
  for (const auto& [label, tolerance] : tolerances)
    method.settings.push_back(
        {.curve = "tolerance",
         .name = label,
         .order = -std::log10(tolerance),
         .parameters = {{"tolerance", label}},
         .make = without_memory([cholesky, tolerance = tolerance](const Image& input) {
           return decompose(input, cholesky, tolerance);
         }),
         .effort = tolerance < 1e-3 ? Setting::Effort::full : Setting::Effort::usual});
  return method;
}

}  // namespace

Method energy_by_conjugate_gradients() {
  return method_of("same energy, CPU CG", "intrinsicdecomp's energy in Eigen, conjugate gradients",
                   false, {{"3e-2", 3e-2}, {"1e-2", 1e-2}, {"1e-3", 1e-3}, {"1e-5", 1e-5}});
}

Method energy_by_cholesky() {
  return method_of("same energy, CPU Cholesky",
                   "intrinsicdecomp's energy in Eigen, sparse Cholesky", true, {{"1e-9", 1e-9}});
}

}  // namespace inverse::bench
