// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "peers.hpp"

namespace inverse::bench {
namespace {

constexpr float kFloor = 1e-3F;
constexpr double kNever = std::numeric_limits<double>::infinity();

/// Steps above these are reflectance.
struct Thresholds {
  double intensity;  ///< of the mean log intensity
  double chroma;     ///< of log chromaticity
};

Decomposition retinex(const Image& input, const Thresholds& params) {
  const int w = input.width, h = input.height, n = w * h;
  std::vector<std::array<double, 3>> q(static_cast<std::size_t>(n));
  std::vector<double> m(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    std::array<double, 3> l{};
    for (int c = 0; c < 3; ++c)
      l[std::size_t(c)] =
          std::log(double(std::max(input.data[std::size_t(i) * 3 + c], 0.0F)) + kFloor);
    m[std::size_t(i)] = (l[0] + l[1] + l[2]) / 3;
    for (int c = 0; c < 3; ++c)
      q[std::size_t(i)][std::size_t(c)] = l[std::size_t(c)] - m[std::size_t(i)];
  }
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  constexpr double kScale = 1e-8;  // pins the one-dimensional null space
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, kScale);
    b[i] += kScale * m[std::size_t(i)];
  }
  const auto edge = [&](int i, int j) {
    const double dm = m[std::size_t(i)] - m[std::size_t(j)];
    double dq = 0;
    for (int c = 0; c < 3; ++c)
      dq += std::pow(q[std::size_t(i)][std::size_t(c)] - q[std::size_t(j)][std::size_t(c)], 2);
    const bool reflectance = std::abs(dm) > params.intensity || std::sqrt(dq) > params.chroma;
    const double step = reflectance ? 0.0 : dm;
    entries.emplace_back(i, i, 1);
    entries.emplace_back(j, j, 1);
    entries.emplace_back(i, j, -1);
    entries.emplace_back(j, i, -1);
    b[i] += step;
    b[j] -= step;
  };
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      if (x + 1 < w) edge(y * w + x, y * w + x + 1);
      if (y + 1 < h) edge(y * w + x, (y + 1) * w + x);
    }
  Eigen::SparseMatrix<double> a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(a);
  if (solver.info() != Eigen::Success) throw std::runtime_error("Retinex: factorization failed");
  const Eigen::VectorXd s = solver.solve(b);
  Image shading(w, h, 1);
  for (int i = 0; i < n; ++i) shading.data[std::size_t(i)] = float(std::exp(s[i]));
  return divide(input, std::move(shading));
}

void add(Method& method, const char* name, double order, const Thresholds& thresholds,
         Setting::Effort effort) {
  method.settings.push_back({.curve = "thresholds",
                             .name = name,
                             .order = order,
                             .parameters = {{"intensity", text_of(thresholds.intensity)},
                                            {"chroma", text_of(thresholds.chroma)}},
                             .make = without_memory([thresholds](const Image& frame) {
                               return retinex(frame, thresholds);
                             }),
                             .photographs = true,
                             .effort = effort});
}

}  // namespace

Method gray_retinex() {
  Method method{
      "gray Retinex", "peer", "Steps of intensity above a threshold are paint", {}, {}, {}};
  add(method, "t .1", 0, {0.1, kNever}, Setting::Effort::brief);
  return method;
}

Method color_retinex() {
  Method method{"color Retinex",
                "peer",
                "Steps of intensity or chroma above thresholds are paint",
                {},
                {},
                {}};
  add(method, "t .5, c .1", 0, {0.5, 0.1}, Setting::Effort::brief);
  add(method, "c .1", 1, {kNever, 0.1}, Setting::Effort::full);
  return method;
}

}  // namespace inverse::bench
