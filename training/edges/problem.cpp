// SPDX-License-Identifier: LGPL-2.1-or-later
#include "problem.hpp"

#include <array>
#include <random>

#include "colored_light.hpp"
#include "tests/reference/intrinsic/intrinsic_decomposition.hpp"
#include "tests/reference/intrinsic/intrinsic_features.hpp"

namespace inverse::training {
namespace {

using reference::kBins;

float weight_of(float log_weight) {
  return std::exp(std::clamp(log_weight, float(reference::kLogLow), float(reference::kLogHigh)));
}

/// Gradient through the clamp, let through where it leads back inside.
float clamped(float log_weight, float g) {
  return (log_weight < float(reference::kLogHigh) || g > 0) &&
                 (log_weight > float(reference::kLogLow) || g < 0)
             ? g
             : 0;
}

// --- the linear system
// -----------------------------------------------------------------------------

/// A plane of w x h pixels with w zeros before and after them.
class Padded {
 public:
  Padded(int w, int h) : before_(std::size_t(w)), values_(std::size_t(w) * std::size_t(h + 2), 0) {}
  float* data() { return values_.data() + before_; }
  const float* data() const { return values_.data() + before_; }

 private:
  std::size_t before_ = 0;
  Plane values_;
};

/// A grid and the weights between its pixels: right of pixels i and i + 1, 0 at the end of a row;
/// down of pixels i and i + w, 0 in the last row. With them and the padding, loops need no borders.
struct Level {
  int w, h;
  Padded right, down, s, next;
  Plane own, diagonal, f;

  Level(int width, int height)
      : w(width),
        h(height),
        right(w, h),
        down(w, h),
        s(w, h),
        next(w, h),
        own(count(), 0),
        f(own) {}
  std::size_t count() const { return std::size_t(w) * std::size_t(h); }

  /// out[i] = combine(i, the sum over neighbors of weight * v)
  template <class F>
  void for_sums(const Padded& plane, float* out, F combine) const {
    const std::ptrdiff_t n = std::ptrdiff_t(count());
    const float *v = plane.data(), *r = right.data(), *d = down.data();
    for (std::ptrdiff_t i = 0; i < n; ++i)
      out[i] =
          combine(i, r[i - 1] * v[i - 1] + r[i] * v[i + 1] + d[i - w] * v[i - w] + d[i] * v[i + w]);
  }
  void sum_diagonal() {
    Padded ones(w, h);
    std::fill_n(ones.data(), count(), 1.0F);
    diagonal.resize(count());
    for_sums(ones, diagonal.data(), [&](auto i, float sum) { return own[std::size_t(i)] + sum; });
  }
  /// Damped Jacobi steps, the first from zero.
  void smooth_from_zero() {
    for (std::size_t i = 0; i < count(); ++i) s.data()[i] = kDamping * f[i] / diagonal[i];
  }
  void smooth() {
    const float *b = f.data(), *a = diagonal.data(), *v = s.data();
    for_sums(s, next.data(),
             [=](auto i, float sum) { return v[i] + kDamping * ((b[i] + sum) / a[i] - v[i]); });
    std::swap(s, next);
  }
  /// Residual, left in `next`.
  const float* residual() {
    const float *b = f.data(), *a = diagonal.data(), *v = s.data();
    for_sums(s, next.data(), [=](auto i, float sum) { return b[i] + sum - a[i] * v[i]; });
    return next.data();
  }

  static constexpr float kDamping = 0.8F;
};

/// Edges at full resolution, `screen` on the cells, minus the projection onto the chroma bins.
class System {
 public:
  System(const Example& e, const Plane& right, const Plane& down, Plane screen, Plane g)
      : e_(e), screen_(std::move(screen)), g_(std::move(g)) {
    Level& first = levels_.emplace_back(e.width, e.height);
    std::copy(right.begin(), right.end(), first.right.data());
    std::copy(down.begin(), down.end(), first.down.data());
    std::fill(first.own.begin(), first.own.end(), 1e-6F);
    while (levels_.size() < 3 || std::max(levels_.back().w, levels_.back().h) > 2) {
      const Level& f = levels_.back();
      Level c((f.w + 1) / 2, (f.h + 1) / 2);
      for (int y = 0; y < f.h; ++y)
        for (int x = 0; x < f.w; ++x) {
          const std::size_t i = std::size_t(y) * f.w + x,
                            j = std::size_t(y / 2) * c.w + std::size_t(x / 2);
          c.own[j] += f.own[i];
          if (x % 2 == 1) c.right.data()[j] += 0.5F * f.right.data()[i];
          if (y % 2 == 1) c.down.data()[j] += 0.5F * f.down.data()[i];
        }
      if (levels_.size() == 2)
        for (std::size_t j = 0; j < c.count(); ++j) c.own[j] += screen_[j];
      levels_.push_back(std::move(c));
    }
    for (Level& l : levels_) l.sum_diagonal();
    weight_ = splat([](std::size_t) { return 1.0F; });
  }

  const Plane& bin_weight() const { return weight_; }

  /// Sum over cells of hat * g * value(cell) for every bin.
  template <class T>
  Plane splat(T value) const {
    Plane out(std::size_t(kBins) * kBins, 0);
    for (std::size_t j = 0; j < g_.size(); ++j) {
      const float u = e_.bin_fraction[2 * j], v = e_.bin_fraction[2 * j + 1], q = g_[j] * value(j);
      float* z = &out[std::size_t(e_.bin[j])];
      z[0] += (1 - u) * (1 - v) * q, z[1] += u * (1 - v) * q;
      z[kBins] += (1 - u) * v * q, z[kBins + 1] += u * v * q;
    }
    return out;
  }
  float slice(const Plane& grid, std::size_t j) const {
    const float u = e_.bin_fraction[2 * j], v = e_.bin_fraction[2 * j + 1];
    const float* z = &grid[std::size_t(e_.bin[j])];
    return (1 - v) * ((1 - u) * z[0] + u * z[1]) + v * ((1 - u) * z[kBins] + u * z[kBins + 1]);
  }
  /// The bin means of a cell plane, read back at every cell.
  Plane bin_mean(const Plane& cells) const {
    Plane grid = splat([&](std::size_t j) { return cells[j]; }), out(cells.size());
    for (std::size_t k = 0; k < grid.size(); ++k) grid[k] /= weight_[k] + 1e-6F;
    for (std::size_t j = 0; j < out.size(); ++j) out[j] = slice(grid, j);
    return out;
  }
  Plane cell_mean(const float* v) const {
    Plane out(screen_.size(), 0);
    for_cells([&](std::size_t i, std::size_t j) { out[j] += v[i]; });
    for (std::size_t j = 0; j < out.size(); ++j) out[j] /= e_.cell_count[j];
    return out;
  }
  /// Adds the transpose of cell_mean.
  void add_cells(Plane cells, Plane& v) const {
    for (std::size_t j = 0; j < cells.size(); ++j) cells[j] /= e_.cell_count[j];
    for_cells([&](std::size_t i, std::size_t j) { v[i] += cells[j]; });
  }

  /// Conjugate gradients, preconditioned by one symmetric V-cycle, from the start in x.
  void solve(const Plane& b, Plane& x, int limit, float tolerance) {
    const std::size_t n = b.size();
    Padded direction(e_.width, e_.height);
    float* p = direction.data();
    std::copy(x.begin(), x.end(), p);
    Plane r = apply(direction), q;
    double target = 0, rz = 0;
    for (std::size_t i = 0; i < n; ++i) r[i] = b[i] - r[i], target += double(b[i]) * b[i];
    target *= double(tolerance) * tolerance;
    for (int k = 0; k < limit; ++k) {
      double rr = 0, rz_new = 0, pq = 0;
      for (float v : r) rr += double(v) * v;
      if (rr <= target) return;
      const float* z = precondition(r);
      for (std::size_t i = 0; i < n; ++i) rz_new += double(r[i]) * z[i];
      const float beta = k ? float(rz_new / rz) : 0;
      rz = rz_new;
      for (std::size_t i = 0; i < n; ++i) p[i] = z[i] + beta * p[i];
      q = apply(direction);
      for (std::size_t i = 0; i < n; ++i) pq += double(p[i]) * q[i];
      if (pq <= 0) return;
      const float alpha = float(rz / pq);
      for (std::size_t i = 0; i < n; ++i) x[i] += alpha * p[i], r[i] -= alpha * q[i];
    }
  }

 private:
  /// Calls f(pixel, its cell) for all pixels.
  template <class F>
  void for_cells(F f) const {
    std::size_t i = 0;
    for (int y = 0; y < e_.height; ++y) {
      const std::size_t row = std::size_t(y / 4) * std::size_t(e_.cells_x);
      for (int x = 0; x < e_.width; ++x, ++i) f(i, row + std::size_t(x / 4));
    }
  }
  Plane apply(const Padded& x) const {
    const Level& l = levels_[0];
    Plane out(l.count()), cells = cell_mean(x.data());
    const Plane mean = bin_mean(cells);
    for (std::size_t j = 0; j < cells.size(); ++j)
      cells[j] = screen_[j] * cells[j] - g_[j] * mean[j];
    const float *a = l.diagonal.data(), *v = x.data();
    l.for_sums(x, out.data(), [=](auto i, float sum) { return a[i] * v[i] - sum; });
    add_cells(std::move(cells), out);
    return out;
  }
  const float* precondition(const Plane& r) {
    levels_[0].f = r;
    cycle(0);
    return levels_[0].s.data();
  }
  void cycle(std::size_t k) {
    Level& l = levels_[k];
    l.smooth_from_zero();
    if (k + 1 == levels_.size()) {
      for (int n = 0; n < 16; ++n) l.smooth();
      return;
    }
    l.smooth();
    Level& c = levels_[k + 1];
    std::fill(c.f.begin(), c.f.end(), 0.0F);
    const float* left = l.residual();
    for (int y = 0; y < l.h; ++y, left += l.w) {
      float* to = &c.f[std::size_t(y / 2) * std::size_t(c.w)];
      for (int x = 0; x < l.w; ++x) to[x / 2] += left[x];
    }
    cycle(k + 1);
    float* s = l.s.data();
    for (int y = 0; y < l.h; ++y, s += l.w) {
      const float* from = c.s.data() + std::ptrdiff_t(y / 2) * c.w;
      for (int x = 0; x < l.w; ++x) s[x] += from[x / 2];
    }
    l.smooth(), l.smooth();
  }

  const Example& e_;
  Plane screen_, g_, weight_;
  std::vector<Level> levels_;
};

/// The windowed scale-invariant error of planes, and the truth's energy in the same windows. `add`
/// adds the derivative by the estimate to `d`. Pixels outside of the mask are 0 in both planes.
struct Windowed {
  double error = 0, energy = 0;

  void add(const Plane& estimate, const Plane& truth, int w, int h, int k, int step, Plane& d) {
    for (int y0 = 0; y0 == 0 || y0 + k <= h; y0 += step)
      for (int x0 = 0; x0 == 0 || x0 + k <= w; x0 += step) {
        const int y1 = std::min(h, y0 + k), x1 = std::min(w, x0 + k);
        double ee = 0, et = 0, tt = 0;
        for (int y = y0; y < y1; ++y) {
          std::array<float, 3> row{};
          for (std::size_t i = std::size_t(y) * w + x0; i < std::size_t(y) * w + x1; ++i) {
            const float a = estimate[i], t = truth[i];
            row[0] += a * a, row[1] += a * t, row[2] += t * t;
          }
          ee += row[0], et += row[1], tt += row[2];
        }
        energy += tt;
        if (ee < 1e-9) continue;
        const float alpha = float(et / ee);
        error += tt - et * et / ee;
        for (int y = y0; y < y1; ++y)
          for (std::size_t i = std::size_t(y) * w + x0; i < std::size_t(y) * w + x1; ++i)
            d[i] -= 2 * alpha * (truth[i] - alpha * estimate[i]);
      }
  }
};

/// Error of log shading: what is dark counts here, too.
double log_error(const Example& e, const Plane& s, Plane& gradient) {
  constexpr double kWeight = 0.4, kNear = 0.1;
  const std::size_t n = s.size();
  Plane weight(n, 0), off(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const float truth = e.shading.data[i];
    if (e.mask.data[i] < 0.5F || truth < 1e-4F) continue;
    weight[i] = float(brightness_weight(e.m[i]));
    off[i] = s[i] - std::log(truth);
  }
  return distance_from_mean(weight, off, kNear, kWeight, gradient);
}

/// Distance of ln R from that of the same scene in another light.
double alike_error(const Example& e, const Plane& s, const LossWeights& weights, Plane& gradient) {
  constexpr double kNear = 0.02;
  if (!weights.other || weights.other->size() != s.size()) return 0;
  const std::size_t n = s.size();
  Plane weight(n, 0), off(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    if (e.mask.data[i] < 0.5F) continue;
    weight[i] = float(brightness_weight(e.m[i]));
    off[i] = s[i] - e.m[i] + (*weights.other)[i];
  }
  return distance_from_mean(weight, off, kNear, weights.alike, gradient);
}

/// Errors of ln R over pairs of pixels, and their derivative: the mean distance of pairs of one
/// paint, and how much pairs of different paint lack of their difference, up to kAsked. Both are
/// pseudo-Huber distances.
double pair_error(const Example& e, const Plane& s, const LossWeights& weights, Plane& gradient) {
  constexpr double kNear = 0.05, kAsked = 0.4;
  double error = 0;
  const auto add = [&](const auto& pair, double off, double share) {
    const double root = std::sqrt(off * off + kNear * kNear);
    error += share * (root - kNear);
    gradient[pair.i] -= float(share * off / root);
    gradient[pair.j] += float(share * off / root);
  };
  const auto step = [&](const auto& pair) {
    return double(e.m[pair.i] - s[pair.i] - e.m[pair.j] + s[pair.j]);
  };
  const double equal = weights.equal / double(std::max(e.equal.size(), std::size_t(1)));
  for (const Pair& pair : e.equal) add(pair, step(pair), equal);
  const double different = weights.different / double(std::max(e.different.size(), std::size_t(1)));
  for (const Pair& pair : e.different) {
    const double asked = std::clamp(double(pair.step), -kAsked, kAsked), off = step(pair) - asked;
    if (off * asked < 0) add(pair, off, different);
  }
  return error;
}

}  // namespace

double brightness_weight(float m) {
  constexpr double kDark = 0.02;
  const double light = std::exp(double(m));
  return light / (light + kDark);
}

double distance_from_mean(const Plane& weight, const Plane& off, double near, double factor,
                          Plane& gradient) {
  const std::size_t n = off.size();
  Plane pull(n, 0);
  double all = 1e-9, mean = 0;
  for (std::size_t i = 0; i < n; ++i) all += weight[i], mean += weight[i] * off[i];
  double error = 0, sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (weight[i] == 0) continue;
    const double d = off[i] - mean / all, root = std::sqrt(d * d + near * near);
    error += factor * weight[i] * (root - near) / all;
    pull[i] = float(factor * weight[i] * d / (root * all));
    sum += pull[i];
  }
  for (std::size_t i = 0; i < n; ++i) gradient[i] += float(pull[i] - sum * weight[i] / all);
  return error;
}

Model::Model(int edge_hidden, int cell_hidden)
    : edge{reference::kEdgeFeatures, edge_hidden, 2, 0},
      cell{reference::kCellFeatures, cell_hidden, 3, edge.count()} {}

Example make_example(const Scene& scene, double k) {
  Example e;
  Scene seen = without_light_color(scene, k);
  e.input = std::move(seen.input), e.reflectance = std::move(seen.reflectance);
  e.shading = std::move(seen.shading), e.mask = std::move(seen.mask);
  const std::vector<double> rgb(e.input.data.begin(), e.input.data.end());
  e.width = e.input.width, e.height = e.input.height;
  const reference::Guide guide = reference::make_guide(rgb.data(), e.width, e.height);
  const reference::GuideLevel &l = guide.level[0], &cells = guide.level[reference::kCellLevel];
  e.m.assign(l.m.begin(), l.m.end());
  e.cells_x = cells.width, e.cells_y = cells.height;
  const std::size_t n = e.m.size(), cell_count = cells.m.size();
  e.right.assign(reference::kEdgeFeatures, Plane(n)), e.down = e.right;
  e.cell.assign(reference::kCellFeatures, Plane(cell_count));
  std::array<double, reference::kEdgeFeatures> f{};
  std::array<double, reference::kCellFeatures> c{};
  for (int y = 0; y < e.height; ++y)
    for (int x = 0; x < e.width; ++x)
      for (const bool down : {false, true}) {
        reference::edge_features(guide, x, y, down, f.data());
        for (std::size_t k = 0; k < f.size(); ++k)
          (down ? e.down : e.right)[k][l.index(x, y)] = float(f[k]);
      }
  e.cell_m.assign(cell_count, 0), e.cell_count = e.cell_m, e.cell_value = e.cell_m;
  for (std::size_t i = 0; i < n; ++i) {
    e.cell_m[std::size_t(e.cell_of(int(i)))] += e.m[i];
    e.cell_count[std::size_t(e.cell_of(int(i)))] += 1;
  }
  e.bin.resize(cell_count), e.bin_fraction.resize(2 * cell_count);
  for (int y = 0; y < e.cells_y; ++y)
    for (int x = 0; x < e.cells_x; ++x) {
      const std::size_t j = cells.index(x, y);
      reference::cell_features(guide, x, y, c.data());
      for (std::size_t k = 0; k < c.size(); ++k) e.cell[k][j] = float(c[k]);
      e.cell_m[j] /= e.cell_count[j];
      e.cell_value[j] = float(cells.m[j] + cells.u[j]);
      const auto place = [](double v) {
        return std::clamp(v / reference::kBinWidth + kBins / 2, 0.0, kBins - 1.001);
      };
      const double u = place(cells.c0[j]), v = place(cells.c1[j]);
      e.bin[j] = int(v) * kBins + int(u);
      e.bin_fraction[2 * j] = float(u - int(u)), e.bin_fraction[2 * j + 1] = float(v - int(v));
    }
  const float cue = float(std::min(std::abs(k), 1.0));
  e.right.back().assign(n, cue), e.down.back().assign(n, cue),
      e.cell.back().assign(cell_count, cue);
  return e;
}

void draw_pairs(Example& e) {
  constexpr std::size_t kPairs = 1500, kTries = 40 * kPairs, kMinUsable = 100;
  constexpr double kEqual = 0.05, kDifferent = 0.15;
  constexpr float kDarkest = -4;  // m
  const auto& r = e.reflectance.data;
  std::vector<std::size_t> usable;
  for (std::size_t i = 0; i < e.m.size(); ++i)
    if (e.mask.data[i] > 0.5F && e.shading.data[i] > 1e-4F && e.m[i] > kDarkest &&
        std::min({r[3 * i], r[3 * i + 1], r[3 * i + 2]}) > 1e-3F)
      usable.push_back(i);
  std::mt19937 engine(unsigned(e.m.size()));
  for (std::size_t k = 0; k < kTries && usable.size() > kMinUsable && e.equal.size() < kPairs;
       ++k) {
    const std::size_t i = usable[engine() % usable.size()], j = usable[engine() % usable.size()];
    double apart = 0, step = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double ratio = std::log(double(r[3 * i + c]) / double(r[3 * j + c]));
      apart = std::max(apart, std::abs(ratio)), step += ratio / 3;
    }
    if (apart < kEqual)
      e.equal.push_back({i, j, 0});
    else if (std::abs(step) > kDifferent && e.different.size() < kPairs)
      e.different.push_back({i, j, float(step)});
  }
}

double loss(const Example& e, const Plane& s, Plane& gradient, const LossWeights& weights) {
  struct Scale {
    int k, step;
    double weight;
  };
  constexpr std::array<Scale, 3> kScales{{{20, 10, 1.0}, {60, 30, 0.5}, {1 << 20, 1 << 20, 0.5}}};
  const std::size_t n = s.size();
  std::array<Plane, 4> found, truth, d;  // shading, then reflectance
  for (std::size_t q = 0; q < 4; ++q) found[q].resize(n), truth[q].resize(n), d[q].resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (e.mask.data[i] < 0.5F) continue;
    found[0][i] = std::exp(std::clamp(s[i], -12.0F, 4.0F)), truth[0][i] = e.shading.data[i];
    for (std::size_t c = 0; c < 3; ++c) {
      found[1 + c][i] = e.input.data[3 * i + c] / found[0][i];
      truth[1 + c][i] = e.reflectance.data[3 * i + c];
    }
  }
  double error = 0;
  gradient.assign(n, 0);
  for (const Scale& scale : kScales)
    for (const auto& [first, last] : {std::pair{0U, 1U}, std::pair{1U, 4U}}) {
      Windowed all;
      for (std::size_t q = first; q < last; ++q) {
        std::fill(d[q].begin(), d[q].end(), 0.0F);
        all.add(found[q], truth[q], e.width, e.height, scale.k, scale.step, d[q]);
      }
      const double weight = 0.5 * scale.weight / std::max(all.energy, 1e-6);
      error += weight * all.error;
      for (std::size_t q = first; q < last; ++q)
        for (std::size_t i = 0; i < n; ++i)
          gradient[i] += float(q == 0 ? weight : -weight) * d[q][i] * found[q][i];
    }
  return error + log_error(e, s, gradient) + pair_error(e, s, weights, gradient) +
         alike_error(e, s, weights, gradient);
}

double evaluate(const Example& e, const Prior& prior, Solution& solution, Prior* gradient,
                const LossWeights& weights) {
  return evaluate(e, prior, solution, gradient,
                  [&](const Plane& s, Plane& d) { return loss(e, s, d, weights); });
}

double evaluate(const Example& e, const Prior& prior, Solution& solution, Prior* gradient,
                const LossOfShading& loss_of) {
  const std::size_t n = e.m.size(), cells = e.cell_m.size(), w = std::size_t(e.width);
  const auto has_right = [&](std::size_t i) { return i % w + 1 < w; };
  const auto has_down = [&](std::size_t i) { return i + w < n; };

  Plane wr(n, 0), wd(n, 0), v(cells), g(cells), screen(cells), target(cells), f(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const auto edge = [&](const std::array<Plane, 2>& o, std::size_t j, Plane& weight) {
      const float a = weight_of(o[0][i]);
      weight[i] = a + weight_of(o[1][i]);
      f[i] += a * (e.m[i] - e.m[j]), f[j] -= a * (e.m[i] - e.m[j]);
    };
    if (has_right(i)) edge(prior.right, i + 1, wr);
    if (has_down(i)) edge(prior.down, i + w, wd);
  }
  for (std::size_t j = 0; j < cells; ++j) {
    v[j] = float(reference::kCellArea) * weight_of(prior.cell[0][j]);
    g[j] = float(reference::kCellArea) * weight_of(prior.cell[2][j]);
    screen[j] = v[j] + g[j];
    target[j] = e.cell_value[j] + prior.cell[1][j];
  }
  System system(e, wr, wd, screen, g);
  const Plane mean = system.bin_mean(e.cell_m);
  Plane pull(cells);
  for (std::size_t j = 0; j < cells; ++j)
    pull[j] = v[j] * target[j] + g[j] * (e.cell_m[j] - mean[j]);
  system.add_cells(pull, f);
  if (solution.s.size() != n) {
    solution.s.resize(n), solution.adjoint.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i) solution.s[i] = target[std::size_t(e.cell_of(int(i)))];
  }
  system.solve(f, solution.s, gradient ? 25 : 60, gradient ? 1e-3F : 2e-4F);
  Plane d_s;
  const double value = loss_of(solution.s, d_s);
  if (!gradient) return value;

  // Adjoint: A lambda = dL/ds; every dL/dweight is -lambda' (dA s - df).
  system.solve(d_s, solution.adjoint, 20, 1e-2F);
  const Plane &s = solution.s, &lambda = solution.adjoint;
  gradient->right.fill(Plane(n, 0)), gradient->down = gradient->right;
  gradient->cell.fill(Plane(cells, 0));
  for (std::size_t i = 0; i < n; ++i) {
    const auto edge = [&](const std::array<Plane, 2>& o, std::size_t j, std::array<Plane, 2>& d) {
      const float l = lambda[i] - lambda[j], ds = s[i] - s[j], dm = e.m[i] - e.m[j];
      d[0][i] = clamped(o[0][i], -l * (ds - dm) * weight_of(o[0][i]));
      d[1][i] = clamped(o[1][i], -l * ds * weight_of(o[1][i]));
    };
    if (has_right(i)) edge(prior.right, i + 1, gradient->right);
    if (has_down(i)) edge(prior.down, i + w, gradient->down);
  }
  const Plane s_cell = system.cell_mean(s.data()), l_cell = system.cell_mean(lambda.data());
  Plane q(cells);
  for (std::size_t j = 0; j < cells; ++j) q[j] = s_cell[j] - e.cell_m[j];
  const Plane q_mean = system.bin_mean(q), l_mean = system.bin_mean(l_cell);
  Plane product = system.splat([&](std::size_t j) { return q[j]; });
  const Plane l_sum = system.splat([&](std::size_t j) { return l_cell[j]; });
  for (std::size_t k = 0; k < product.size(); ++k) {
    const float d = system.bin_weight()[k] + 1e-6F;
    product[k] *= l_sum[k] / (d * d);
  }
  for (std::size_t j = 0; j < cells; ++j) {
    gradient->cell[0][j] = clamped(prior.cell[0][j], -l_cell[j] * (s_cell[j] - target[j]) * v[j]);
    gradient->cell[1][j] = l_cell[j] * v[j];
    const float bins =
        l_cell[j] * q[j] - l_cell[j] * q_mean[j] - l_mean[j] * q[j] + system.slice(product, j);
    gradient->cell[2][j] = clamped(prior.cell[2][j], -g[j] * bins);
  }
  return value;
}

Prior fitted_prior(const Model& model, const std::vector<float>& parameters, const Example& e) {
  std::vector<Plane> hidden;
  Prior prior;
  model.edge.forward(parameters, e.right, hidden, prior.right);
  model.edge.forward(parameters, e.down, hidden, prior.down);
  model.cell.forward(parameters, e.cell, hidden, prior.cell);
  return prior;
}

double evaluate(const Model& model, const std::vector<float>& parameters, const Example& e,
                Solution& solution, std::vector<double>* gradient, const LossWeights& weights) {
  return evaluate(model, parameters, e, solution, gradient,
                  [&](const Plane& s, Plane& d) { return loss(e, s, d, weights); });
}

double evaluate(const Model& model, const std::vector<float>& parameters, const Example& e,
                Solution& solution, std::vector<double>* gradient, const LossOfShading& loss_of) {
  std::vector<Plane> hidden_right, hidden_down, hidden_cell;
  Prior prior, change;
  model.edge.forward(parameters, e.right, hidden_right, prior.right);
  model.edge.forward(parameters, e.down, hidden_down, prior.down);
  model.cell.forward(parameters, e.cell, hidden_cell, prior.cell);
  const double value = evaluate(e, prior, solution, gradient ? &change : nullptr, loss_of);
  if (!gradient) return value;
  model.edge.backward(parameters, e.right, hidden_right, change.right, *gradient);
  model.edge.backward(parameters, e.down, hidden_down, change.down, *gradient);
  model.cell.backward(parameters, e.cell, hidden_cell, change.cell, *gradient);
  return value;
}

}  // namespace inverse::training
