#include "tests/reference/intrinsic_decomposition.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/reference/intrinsic_edge_weights.hpp"

namespace inverse::reference {
namespace {

double softsign(double v) { return v / (1 + std::abs(v)); }
double weight_of(double log_weight) { return std::exp(std::clamp(log_weight, kLogLow, kLogHigh)); }

/// out = bias2 + skip f + outer softsign(bias1 + inner f)
template <std::size_t H, std::size_t O, std::size_t F>
void evaluate(const SmallNet<H, O, F>& net, const double* f, double* out) {
  std::array<double, H> hidden;
  for (std::size_t h = 0; h < H; ++h) {
    double v = net.bias1[h];
    for (std::size_t k = 0; k < F; ++k) v += net.inner[h][k] * f[k];
    hidden[h] = softsign(v);
  }
  for (std::size_t o = 0; o < O; ++o) {
    out[o] = net.bias2[o];
    for (std::size_t k = 0; k < F; ++k) out[o] += net.skip[o][k] * f[k];
    for (std::size_t h = 0; h < H; ++h) out[o] += net.outer[o][h] * hidden[h];
  }
}

double diagonal_of_edges(const SolverLevel& l, int x, int y) {
  const std::size_t i = std::size_t(y) * l.width + x;
  double d = l.right[i] + l.down[i];
  if (x > 0) d += l.right[i - 1];
  if (y > 0) d += l.down[i - std::size_t(l.width)];
  return d;
}

double residual(const SolverLevel& l, int x, int y) {
  const std::size_t w = std::size_t(l.width), i = std::size_t(y) * w + x;
  double r = l.f[i] - l.diagonal[i] * l.s[i];
  if (x > 0) r += l.right[i - 1] * l.s[i - 1];
  if (x + 1 < l.width) r += l.right[i] * l.s[i + 1];
  if (y > 0) r += l.down[i - w] * l.s[i - w];
  if (y + 1 < l.height) r += l.down[i] * l.s[i + w];
  return r;
}

/// Position on the chroma grid: cell and fraction.
struct GridPoint {
  std::size_t cell;
  double fu, fv;
};
GridPoint grid_point(double c0, double c1) {
  const auto place = [](double c) {
    return std::clamp(c / kBinWidth + kBins / 2, 0.0, kBins - 1.001);
  };
  const double u = place(c0), v = place(c1);
  const int a = int(u), b = int(v);
  return {std::size_t(b) * kBins + std::size_t(a), u - a, v - b};
}

/// How much the anchor is believed at every pixel, and the frame's mean mismatch.
struct Gate {
  std::vector<double> value;
  double mismatch = 0;
};

std::vector<double> detail_of(const Guide& guide) {
  const GuideLevel &l = guide.level[0], &l2 = guide.level[2];
  std::vector<double> d(l.m.size());
  for (int y = 0; y < l.height; ++y)
    for (int x = 0; x < l.width; ++x)
      d[l.index(x, y)] = l.m[l.index(x, y)] - l2.m[l2.index(x >> 2, y >> 2)];
  return d;
}

Gate temporal_gate(const Guide& guide, const std::vector<double>& detail,
                   const IntrinsicState& state, const IntrinsicParams& params) {
  const GuideLevel& l = guide.level[0];
  const auto square = [](double v) { return v * v; };
  Gate gate;
  gate.value.resize(l.m.size());
  const int cw = (l.width + 7) / 8, ch = (l.height + 7) / 8;  // cells of 8 x 8 pixels
  std::vector<double> cell(std::size_t(cw) * ch, 0), count(cell.size(), 0);
  for (int y = 0; y < l.height; ++y)
    for (int x = 0; x < l.width; ++x) {
      const std::size_t i = l.index(x, y), k = std::size_t(y / 8) * cw + std::size_t(x / 8);
      const double q = square((detail[i] - state.detail[i]) / params.anchor_detail) +
                       (square(l.c0[i] - state.c0[i]) + square(l.c1[i] - state.c1[i])) /
                           square(params.anchor_chroma);
      gate.value[i] = 1 / (1 + q);
      cell[k] += q / (1 + q);
      count[k] += 1;
      gate.mismatch += q / (1 + q) / double(l.m.size());
    }
  for (int y = 0; y < l.height; ++y)
    for (int x = 0; x < l.width; ++x) {
      const std::size_t i = l.index(x, y), k = std::size_t(y / 8) * cw + std::size_t(x / 8);
      const double e = cell[k] / count[k];
      gate.value[i] *= square(std::max(0.0, 1 - 2 * e));
    }
  return gate;
}

}  // namespace

EdgePrior edge_prior(const Guide& guide, const IntrinsicParams& params) {
  const GuideLevel& l = guide.level[0];
  const std::size_t n = l.m.size();
  EdgePrior p;
  for (auto* plane : {&p.a_right, &p.b_right, &p.a_down, &p.b_down, &p.v, &p.V, &p.g})
    plane->assign(n, 0.0);
  std::array<double, kEdgeFeatures> ef{};
  std::array<double, kPixelFeatures> pf{};
  std::array<double, 3> out{};
  for (int y = 0; y < l.height; ++y)
    for (int x = 0; x < l.width; ++x) {
      const std::size_t i = l.index(x, y);
      if (x + 1 < l.width) {
        edge_features(guide, x, y, false, ef.data());
        evaluate(kEdgeNet, ef.data(), out.data());
        p.a_right[i] = params.reflectance_weight * weight_of(out[0]);
        p.b_right[i] = params.shading_weight * weight_of(out[1]);
      }
      if (y + 1 < l.height) {
        edge_features(guide, x, y, true, ef.data());
        evaluate(kEdgeNet, ef.data(), out.data());
        p.a_down[i] = params.reflectance_weight * weight_of(out[0]);
        p.b_down[i] = params.shading_weight * weight_of(out[1]);
      }
      pixel_features(guide, x, y, pf.data());
      evaluate(kPixelNet, pf.data(), out.data());
      p.v[i] = params.value_weight * weight_of(out[0]);
      p.V[i] = l.m[i] + l.u[i] + out[1];
      p.g[i] = params.chroma_weight * weight_of(out[2]);
    }
  return p;
}

ChromaBins splat_bins(const Guide& guide, const EdgePrior& prior, const std::vector<double>& s) {
  const GuideLevel &l = guide.level[0], &l2 = guide.level[2];
  ChromaBins bins{std::vector<double>(std::size_t(kBins) * kBins, 0.0), {}};
  bins.weight = bins.mean;
  for (int cy = 0; cy < l2.height; ++cy)
    for (int cx = 0; cx < l2.width; ++cx) {
      double weight = 0, sum = 0;
      for (int y = 4 * cy; y < std::min(l.height, 4 * cy + 4); ++y)
        for (int x = 4 * cx; x < std::min(l.width, 4 * cx + 4); ++x) {
          const std::size_t i = l.index(x, y);
          weight += prior.g[i];
          sum += prior.g[i] * (l.m[i] - s[i]);
        }
      const std::size_t k = l2.index(cx, cy);
      const GridPoint p = grid_point(l2.c0[k], l2.c1[k]);
      const std::array<double, 4> hat{(1 - p.fu) * (1 - p.fv), p.fu * (1 - p.fv), (1 - p.fu) * p.fv,
                                      p.fu * p.fv};
      const std::array<std::size_t, 4> at{p.cell, p.cell + 1, p.cell + kBins, p.cell + kBins + 1};
      for (std::size_t j = 0; j < 4; ++j) {
        bins.weight[at[j]] += hat[j] * weight;
        bins.mean[at[j]] += hat[j] * sum;
      }
    }
  for (std::size_t k = 0; k < bins.mean.size(); ++k) bins.mean[k] /= bins.weight[k] + 1e-6;
  return bins;
}

double slice_bins(const ChromaBins& bins, double c0, double c1, double* weight) {
  const GridPoint p = grid_point(c0, c1);
  const std::array<double, 4> hat{(1 - p.fu) * (1 - p.fv), p.fu * (1 - p.fv), (1 - p.fu) * p.fv,
                                  p.fu * p.fv};
  const std::array<std::size_t, 4> at{p.cell, p.cell + 1, p.cell + kBins, p.cell + kBins + 1};
  double sum = 0, total = 0;
  for (std::size_t j = 0; j < 4; ++j) {
    const double w = bins.weight[at[j]] > 0 ? hat[j] : 0;
    sum += w * bins.mean[at[j]];
    total += w;
  }
  *weight = total;
  return total > 0 ? sum / total : 0;
}

SolverLevel coarsen(const SolverLevel& fine) {
  SolverLevel c;
  c.width = (fine.width + 1) / 2, c.height = (fine.height + 1) / 2;
  const std::size_t n = std::size_t(c.width) * c.height;
  for (auto* plane : {&c.right, &c.down, &c.diagonal, &c.f, &c.s}) plane->assign(n, 0.0);
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) {
      const std::size_t i = std::size_t(y) * fine.width + x,
                        j = std::size_t(y / 2) * c.width + std::size_t(x / 2);
      c.diagonal[j] += fine.diagonal[i] - diagonal_of_edges(fine, x, y);
      if (x % 2 == 1) c.right[j] += kCoarseScale * fine.right[i];
      if (y % 2 == 1) c.down[j] += kCoarseScale * fine.down[i];
    }
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; ++x)
      c.diagonal[std::size_t(y) * c.width + x] += diagonal_of_edges(c, x, y);
  return c;
}

void smooth(SolverLevel& l, int shift) {
  const std::size_t w = std::size_t(l.width);
  const std::vector<double> old = l.s;
  for (int by = -shift; by < l.height; by += kBlock)
    for (int bx = 0; bx < l.width; bx += kBlock) {
      const int x0 = bx, x1 = std::min(l.width, bx + kBlock);
      const int y0 = std::max(0, by), y1 = std::min(l.height, by + kBlock);
      const auto relax = [&](int x, int y) {
        const std::size_t i = std::size_t(y) * w + x;
        double v = l.f[i];
        if (x > 0) v += l.right[i - 1] * (x > x0 ? l.s[i - 1] : old[i - 1]);
        if (x + 1 < l.width) v += l.right[i] * (x + 1 < x1 ? l.s[i + 1] : old[i + 1]);
        if (y > 0) v += l.down[i - w] * (y > y0 ? l.s[i - w] : old[i - w]);
        if (y + 1 < l.height) v += l.down[i] * (y + 1 < y1 ? l.s[i + w] : old[i + w]);
        l.s[i] = v / l.diagonal[i];
      };
      for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) relax(x, y);
      for (int y = y1 - 1; y >= y0; --y)
        for (int x = x1 - 1; x >= x0; --x) relax(x, y);
    }
}

void cycle(std::vector<SolverLevel>& levels, std::size_t k, const IntrinsicParams& params) {
  SolverLevel& l = levels[k];
  if (k + 1 == levels.size()) {
    for (int n = 0; n < params.coarsest_sweeps; ++n) smooth(l, n % 2 ? kBlock / 2 : 0);
    return;
  }
  smooth(l, 0);
  SolverLevel& c = levels[k + 1];
  std::fill(c.f.begin(), c.f.end(), 0.0);
  std::fill(c.s.begin(), c.s.end(), 0.0);
  for (int y = 0; y < l.height; ++y)
    for (int x = 0; x < l.width; ++x)
      c.f[std::size_t(y / 2) * c.width + std::size_t(x / 2)] += residual(l, x, y);
  cycle(levels, k + 1, params);
  for (int y = 0; y < l.height; ++y)
    for (int x = 0; x < l.width; ++x)
      l.s[std::size_t(y) * l.width + x] += c.s[std::size_t(y / 2) * c.width + std::size_t(x / 2)];
  smooth(l, kBlock / 2);
}

IntrinsicResult decompose(const double* rgb, int width, int height, const IntrinsicParams& params,
                          IntrinsicState* state) {
  const Guide guide = make_guide(rgb, width, height);
  const EdgePrior prior = edge_prior(guide, params);
  const GuideLevel& l = guide.level[0];
  const std::size_t n = l.m.size(), w = std::size_t(width);
  IntrinsicResult result;

  // Temporal anchor.
  const std::vector<double> detail = detail_of(guide);
  std::vector<double> anchor(n, 0.0), start = prior.V;
  if (state && state->width == width && state->height == height && !state->rho.empty()) {
    const Gate gate = temporal_gate(guide, detail, *state, params);
    result.stats.mismatch = gate.mismatch;
    result.stats.anchored = gate.mismatch < params.cut_fraction;
    if (result.stats.anchored)
      for (std::size_t i = 0; i < n; ++i) {
        anchor[i] = params.anchor_weight * gate.value[i];
        start[i] += gate.value[i] * (l.m[i] - state->rho[i] - start[i]);
      }
  }

  // Operators of all levels.
  std::vector<SolverLevel> levels(1);
  SolverLevel& fine = levels[0];
  fine.width = width, fine.height = height;
  fine.right.resize(n), fine.down.resize(n), fine.diagonal.resize(n), fine.f.resize(n);
  fine.s = start;
  std::vector<double> base(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    fine.right[i] = prior.a_right[i] + prior.b_right[i];
    fine.down[i] = prior.a_down[i] + prior.b_down[i];
    base[i] += prior.v[i] * prior.V[i];
    if (anchor[i] > 0) base[i] += anchor[i] * (l.m[i] - state->rho[i]);
    const std::size_t x = i % w;
    if (x + 1 < w) {
      const double step = prior.a_right[i] * (l.m[i] - l.m[i + 1]);
      base[i] += step, base[i + 1] -= step;
    }
    if (i + w < n) {
      const double step = prior.a_down[i] * (l.m[i] - l.m[i + w]);
      base[i] += step, base[i + w] -= step;
    }
  }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = l.index(x, y);
      fine.diagonal[i] = diagonal_of_edges(fine, x, y) + prior.v[i] + prior.g[i] + anchor[i];
    }
  while (std::max(levels.back().width, levels.back().height) > kBlock)
    levels.push_back(coarsen(levels.back()));

  // Cycles against renewed bins.
  SolverLevel& top = levels[0];
  const auto relative_residual = [&] {
    double r = 0, f = 1e-30;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double q = residual(top, x, y);
        r += q * q;
        f += top.f[l.index(x, y)] * top.f[l.index(x, y)];
      }
    return std::sqrt(r / f);
  };
  for (int k = 0; k < params.cycles; ++k) {
    const ChromaBins bins = splat_bins(guide, prior, top.s);
    for (std::size_t i = 0; i < n; ++i) {
      double known = 0;
      const double rho = slice_bins(bins, l.c0[i], l.c1[i], &known);
      const double target = known > 0 ? l.m[i] - rho : top.s[i];
      top.f[i] = base[i] + prior.g[i] * target;
    }
    result.stats.residual.push_back(relative_residual());
    cycle(levels, 0, params);
  }
  result.stats.residual.push_back(relative_residual());

  // Layers and state.
  result.log_shading = top.s;
  result.reflectance.resize(3 * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      result.reflectance[3 * i + c] = sanitize(rgb[3 * i + c]) * std::exp(-top.s[i]);
  if (state) {
    state->width = width, state->height = height;
    state->detail = detail, state->c0 = l.c0, state->c1 = l.c1;
    state->rho.resize(n);
    for (std::size_t i = 0; i < n; ++i) state->rho[i] = l.m[i] - top.s[i];
  }
  return result;
}

}  // namespace inverse::reference
