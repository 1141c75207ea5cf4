// SPDX-License-Identifier: LGPL-2.1-or-later
#include "dense.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace inverse::extremes {
namespace {

/// Reduces a symmetric matrix to tridiagonal form by Householder's reflections; only the diagonal
/// and what is beside it is kept.
void tridiagonalize(Dense& a, std::vector<double>& diagonal, std::vector<double>& beside) {
  const size_t n = a.size();
  diagonal.assign(n, 0);
  beside.assign(n, 0);  // beside[i]: between i and i + 1
  std::vector<double> v(n), p(n);
  for (size_t k = 0; k + 2 < n; ++k) {
    double norm = 0;
    for (size_t i = k + 1; i < n; ++i) norm += a.at(i, k) * a.at(i, k);
    norm = std::sqrt(norm);
    if (norm == 0) continue;
    const double alpha = a.at(k + 1, k) > 0 ? -norm : norm;
    double square = 0;
    for (size_t i = k + 1; i < n; ++i) {
      v[i] = a.at(i, k) - (i == k + 1 ? alpha : 0);
      square += v[i] * v[i];
    }
    if (square == 0) continue;
    double vp = 0;
    for (size_t i = k + 1; i < n; ++i) {
      double sum = 0;
      for (size_t j = k + 1; j < n; ++j) sum += a.at(i, j) * v[j];
      p[i] = 2 * sum / square;
      vp += v[i] * p[i];
    }
    for (size_t i = k + 1; i < n; ++i) p[i] -= vp / square * v[i];
    for (size_t i = k + 1; i < n; ++i)
      for (size_t j = k + 1; j < n; ++j) a.at(i, j) -= v[i] * p[j] + p[i] * v[j];
    a.at(k + 1, k) = a.at(k, k + 1) = alpha;
    for (size_t i = k + 2; i < n; ++i) a.at(i, k) = a.at(k, i) = 0;
  }
  for (size_t i = 0; i < n; ++i) {
    diagonal[i] = a.at(i, i);
    if (i + 1 < n) beside[i] = a.at(i + 1, i);
  }
}

}  // namespace

std::vector<double> eigenvalues(Dense matrix) {
  std::vector<double> d, e;
  tridiagonalize(matrix, d, e);
  const size_t n = d.size();
  for (size_t first = 0; first < n; ++first) {
    for (int round = 0;; ++round) {
      size_t last = first;
      for (; last + 1 < n; ++last) {
        const double scale = std::abs(d[last]) + std::abs(d[last + 1]);
        if (std::abs(e[last]) <= std::numeric_limits<double>::epsilon() * scale) break;
      }
      if (last == first) break;
      if (round == 100) throw std::runtime_error("the eigenvalues do not converge");
      double g = (d[first + 1] - d[first]) / (2 * e[first]);
      double r = std::hypot(g, 1.0);
      g = d[last] - d[first] + e[first] / (g + std::copysign(r, g));
      double s = 1, c = 1, p = 0;
      size_t i = last;
      bool split = false;
      while (i-- > first) {
        const double f = s * e[i], b = c * e[i];
        r = std::hypot(f, g);
        e[i + 1] = r;
        if (r == 0) {
          d[i + 1] -= p;
          e[last] = 0;
          split = true;
          break;
        }
        s = f / r;
        c = g / r;
        g = d[i + 1] - p;
        r = (d[i] - g) * s + 2 * c * b;
        p = s * r;
        d[i + 1] = g + p;
        g = c * r - b;
      }
      if (split) continue;
      d[first] -= p;
      e[first] = g;
      e[last] = 0;
    }
  }
  std::sort(d.begin(), d.end());
  return d;
}

double condition_number(const Dense& matrix) {
  const std::vector<double> values = eigenvalues(matrix);
  return values.front() > 0 ? values.back() / values.front()
                            : std::numeric_limits<double>::infinity();
}

Dense scaled_by_diagonal(const Dense& matrix) {
  Dense scaled = matrix;
  for (size_t i = 0; i < matrix.size(); ++i)
    for (size_t j = 0; j < matrix.size(); ++j)
      scaled.at(i, j) /= std::sqrt(matrix.at(i, i) * matrix.at(j, j));
  return scaled;
}

std::vector<double> solve(const Dense& matrix, const std::vector<double>& b) {
  const size_t n = matrix.size();
  std::vector<long double> l(n * n, 0), x(b.begin(), b.end());
  for (size_t j = 0; j < n; ++j) {
    for (size_t i = j; i < n; ++i) {
      long double sum = matrix.at(i, j);
      for (size_t k = 0; k < j; ++k) sum -= l[i * n + k] * l[j * n + k];
      if (i == j && !(sum > 0)) throw std::domain_error("the matrix is not positive definite");
      l[i * n + j] = i == j ? std::sqrt(sum) : sum / l[j * n + j];
    }
  }
  for (size_t i = 0; i < n; ++i) {
    for (size_t k = 0; k < i; ++k) x[i] -= l[i * n + k] * x[k];
    x[i] /= l[i * n + i];
  }
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; ++k) x[i] -= l[k * n + i] * x[k];
    x[i] /= l[i * n + i];
  }
  return {x.begin(), x.end()};
}

std::vector<double> plain_single_precision(const Dense& matrix, const std::vector<double>& b,
                                           int iterations) {
  const size_t n = matrix.size();
  struct Entry {
    size_t column;
    float value;
  };
  std::vector<std::vector<Entry>> rows(n);
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < n; ++j)
      if (matrix.at(i, j) != 0) rows[i].push_back({j, static_cast<float>(matrix.at(i, j))});
  const auto apply = [&](const std::vector<float>& v, std::vector<float>& out) {
    for (size_t i = 0; i < n; ++i) {
      float sum = 0;
      for (const Entry& entry : rows[i]) sum += entry.value * v[entry.column];
      out[i] = sum;
    }
  };
  const auto dot = [&](const std::vector<float>& u, const std::vector<float>& v) {
    float sum = 0;
    for (size_t i = 0; i < n; ++i) sum += u[i] * v[i];
    return sum;
  };
  std::vector<float> x(n, 0), best(n, 0), residual(b.begin(), b.end()), direction = residual, q(n);
  float rr = dot(residual, residual), smallest = rr;
  for (int k = 0; k < iterations; ++k) {
    apply(direction, q);
    const float curvature = dot(direction, q);
    if (!(curvature > 0) || !(rr > 0)) break;
    const float alpha = rr / curvature;
    for (size_t i = 0; i < n; ++i) x[i] += alpha * direction[i];
    const bool anew = k % 50 == 49;
    if (anew) {
      apply(x, q);
      for (size_t i = 0; i < n; ++i) residual[i] = static_cast<float>(b[i]) - q[i];
    } else {
      for (size_t i = 0; i < n; ++i) residual[i] -= alpha * q[i];
    }
    const float next = dot(residual, residual);
    if (next < smallest) {
      smallest = next;
      best = x;
    }
    const float beta = anew ? 0 : next / rr;
    for (size_t i = 0; i < n; ++i) direction[i] = residual[i] + beta * direction[i];
    rr = next;
  }
  return {best.begin(), best.end()};
}

double digits_kept(const std::vector<double>& x, const std::vector<double>& exact) {
  double apart = 0, size = 0;
  for (size_t i = 0; i < exact.size(); ++i) {
    apart += (x[i] - exact[i]) * (x[i] - exact[i]);
    size += exact[i] * exact[i];
  }
  if (!std::isfinite(apart)) return 0;
  if (apart == 0) return 16;
  return std::clamp(-0.5 * std::log10(apart / size), 0.0, 16.0) + 0.0;  // not −0
}

}  // namespace inverse::extremes
