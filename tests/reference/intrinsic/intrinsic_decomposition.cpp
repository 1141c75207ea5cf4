// SPDX-License-Identifier: LGPL-2.1-or-later
#include "intrinsic_decomposition.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "intrinsic_edge_weights.hpp"
#include "multigrid.hpp"

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

/// The four bins around a chroma and their bilinear weights.
struct GridPoint {
  std::array<std::size_t, 4> at;
  std::array<double, 4> hat;
};
GridPoint grid_point(double c0, double c1) {
  const auto place = [](double c) {
    return std::clamp(c / kBinWidth + kBins / 2, 0.0, kBins - 1.001);
  };
  const double u = place(c0), v = place(c1);
  const std::size_t a = std::size_t(u), b = std::size_t(v), cell = b * kBins + a;
  const double fu = u - double(a), fv = v - double(b);
  return {{cell, cell + 1, cell + kBins, cell + kBins + 1},
          {(1 - fu) * (1 - fv), fu * (1 - fv), (1 - fu) * fv, fu * fv}};
}

double square(double v) { return v * v; }

constexpr double kHalfLight = 0.02;      // at which chroma has half weight
constexpr double kHalfStructure = 0.02;  // variance of ln I in a cell, at half weight
constexpr double kFrameStructure = 5;    // of the whole frame, relative to a neighborhood

/// Weight of the anchor at every cell, and the frame's mean mismatch.
struct Gate {
  std::vector<double> value, alike;  // alike: of the cell alone
  double mismatch = 0;
};

std::vector<double> detail_of(const Guide& guide) {
  const GuideLevel &l = guide.level[kCellLevel], &wide = guide.level[kCellLevel + 2];
  std::vector<double> d(l.m.size());
  for (int y = 0; y < l.height; ++y)
    for (int x = 0; x < l.width; ++x)
      d[l.index(x, y)] = l.m[l.index(x, y)] - wide.m[wide.index(x >> 2, y >> 2)];
  return d;
}

double variance(double sum, double squares, double count) {
  return std::max(0.0, squares / count - square(sum / count));
}

/// Variation of the change within every cell since the frame before (variance of the change of m),
/// and its structure (variance of m in both frames).
struct Variation {
  std::vector<double> change, structure;
};
Variation variation_of(const Guide& guide, const IntrinsicState& state) {
  const GuideLevel &fine = guide.level[0], &l = guide.level[kCellLevel];
  struct Sums {
    double change = 0, changes = 0, now = 0, nows = 0, then = 0, thens = 0, count = 0;
  };
  std::vector<Sums> sums(l.m.size());
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) {
      Sums& s = sums[l.index(x >> kCellLevel, y >> kCellLevel)];
      const std::size_t i = fine.index(x, y);
      const double now = fine.m[i], then = state.m[i];
      s.change += now - then, s.changes += square(now - then);
      s.now += now, s.nows += square(now);
      s.then += then, s.thens += square(then);
      s.count += 1;
    }
  Variation variation;
  for (const Sums& s : sums) {
    variation.change.push_back(variance(s.change, s.changes, s.count));
    variation.structure.push_back(variance(s.now, s.nows, s.count) +
                                  variance(s.then, s.thens, s.count));
  }
  return variation;
}

/// Moving share of the structure of 5 x 5 tiles and, with little weight, of the whole frame.
double moved_around(const std::vector<double>& moved, const std::vector<double>& structure,
                    int width, int height, int tx, int ty) {
  const double of_all = std::accumulate(structure.begin(), structure.end(), 0.0);
  const double frame = std::accumulate(moved.begin(), moved.end(), 0.0) / std::max(of_all, 1e-20);
  double sum = kFrameStructure * frame, all = kFrameStructure;
  for (int y = std::max(ty - 2, 0); y <= std::min(ty + 2, height - 1); ++y)
    for (int x = std::max(tx - 2, 0); x <= std::min(tx + 2, width - 1); ++x) {
      sum += moved[std::size_t(y) * std::size_t(width) + std::size_t(x)];
      all += structure[std::size_t(y) * std::size_t(width) + std::size_t(x)];
    }
  return sum / all;
}

Gate temporal_gate(const Guide& guide, const std::vector<double>& detail,
                   const IntrinsicState& state, const IntrinsicParams& params) {
  const GuideLevel& l = guide.level[kCellLevel];
  const Variation variation = variation_of(guide, state);
  Gate gate;
  gate.value.resize(l.m.size());
  gate.alike.resize(l.m.size());
  const int tw = (l.width + 3) / 4, th = (l.height + 3) / 4;  // tiles of 4 x 4 cells
  std::vector<double> tile(std::size_t(tw) * th, 0), count(tile), moved(tile), structure(tile);
  const auto tile_of = [&](int x, int y) { return std::size_t(y / 4) * tw + std::size_t(x / 4); };
  for (int y = 0; y < l.height; ++y)
    for (int x = 0; x < l.width; ++x) {
      const std::size_t i = l.index(x, y), t = tile_of(x, y);
      const double light = std::exp(l.m[i]), trust = light / (light + kHalfLight);
      const double q = square((detail[i] - state.detail[i]) / params.anchor_detail) +
                       (square(l.c0[i] - state.c0[i]) + square(l.c1[i] - state.c1[i])) *
                           square(trust / params.anchor_chroma) +
                       variation.change[i] / square(params.anchor_texture);
      const double counts = variation.structure[i] / (variation.structure[i] + kHalfStructure);
      gate.value[i] = gate.alike[i] = 1 / (1 + q);
      tile[t] += q / (1 + q);
      count[t] += 1;
      moved[t] += counts * variation.change[i];
      structure[t] += counts * variation.structure[i];
      gate.mismatch += q / (1 + q) / double(l.m.size());
    }
  for (int ty = 0; ty < th; ++ty)
    for (int tx = 0; tx < tw; ++tx) {
      const double motion = moved_around(moved, structure, tw, th, tx, ty) / params.anchor_motion;
      const std::size_t t = std::size_t(ty) * tw + std::size_t(tx);
      const double quiet =
          square(std::max(0.0, 1 - 2 * tile[t] / count[t])) / (1 + square(square(motion)));
      for (int y = 4 * ty; y < std::min(l.height, 4 * ty + 4); ++y)
        for (int x = 4 * tx; x < std::min(l.width, 4 * tx + 4); ++x)
          gate.value[l.index(x, y)] *= quiet;
    }
  return gate;
}

/// ln of the mean channel.
double brightness(const double* rgb, std::size_t i) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += sanitize_linear(rgb[3 * i + c]);
  return std::log(sum / 3 + kIntensityFloor);
}

/// A plane of the cells at a pixel, linear between their centers.
double between_cells(const std::vector<double>& plane, const GuideLevel& cells, int x, int y) {
  const double u = (x + 0.5) / 4 - 0.5, v = (y + 0.5) / 4 - 0.5;
  const int left = int(std::floor(u)), top = int(std::floor(v));
  const auto at = [&](int cx, int cy) {
    return plane[cells.index(std::clamp(cx, 0, cells.width - 1),
                             std::clamp(cy, 0, cells.height - 1))];
  };
  const double fu = u - left, fv = v - top;
  return (1 - fv) * ((1 - fu) * at(left, top) + fu * at(left + 1, top)) +
         fv * ((1 - fu) * at(left, top + 1) + fu * at(left + 1, top + 1));
}

}  // namespace

EdgePrior edge_prior(const Guide& guide, const IntrinsicParams& params,
                     const PriorNetwork* network) {
  const GuideLevel& l = guide.level[0];
  const std::size_t n = l.m.size();
  EdgePrior p;
  for (auto* plane : {&p.a_right, &p.b_right, &p.a_down, &p.b_down}) plane->assign(n, 0.0);
  std::array<double, kEdgeFeatures> ef{};
  std::array<double, 3> out{};
  for (int y = 0; y < l.height; ++y)
    for (int x = 0; x < l.width; ++x)
      for (const bool down : {false, true}) {
        if (down ? y + 1 >= l.height : x + 1 >= l.width) continue;
        edge_features(guide, x, y, down, ef.data());
        evaluate(kEdgeNet, ef.data(), out.data());
        (down ? p.a_down : p.a_right)[l.index(x, y)] =
            params.reflectance_weight * weight_of(out[0]);
        (down ? p.b_down : p.b_right)[l.index(x, y)] = params.shading_weight * weight_of(out[1]);
      }
  const GuideLevel& cells = guide.level[kCellLevel];
  for (auto* plane : {&p.v, &p.V, &p.g}) plane->assign(cells.m.size(), 0.0);
  std::array<double, kCellFeatures> cf{};
  for (int y = 0; y < cells.height; ++y)
    for (int x = 0; x < cells.width; ++x) {
      const std::size_t i = cells.index(x, y);
      cell_features(guide, x, y, cf.data());
      evaluate(kCellNet, cf.data(), out.data());
      if (network) {
        const PriorFields field = network->at_cell(x, y);
        for (std::size_t k = 0; k < 3; ++k) out[k] += field[k];
      }
      p.v[i] = kCellArea * params.value_weight * weight_of(out[0]);
      p.V[i] = cells.m[i] + cells.u[i] + out[1];
      p.g[i] = kCellArea * params.chroma_weight * weight_of(out[2]);
    }
  return p;
}

EdgePrior edge_prior(const Guide& guide, const IntrinsicParams& params) {
  std::optional<PriorNetwork> network;
  if (params.network) network.emplace(guide, *params.network);
  return edge_prior(guide, params, network ? &*network : nullptr);
}

ChromaBins splat_bins(const GuideLevel& cells, const std::vector<double>& g,
                      const std::vector<double>& rho) {
  ChromaBins bins{std::vector<double>(std::size_t(kBins) * kBins, 0.0), {}};
  bins.weight = bins.mean;
  for (std::size_t i = 0; i < rho.size(); ++i) {
    const GridPoint p = grid_point(cells.c0[i], cells.c1[i]);
    for (std::size_t j = 0; j < 4; ++j) {
      bins.weight[p.at[j]] += p.hat[j] * g[i];
      bins.mean[p.at[j]] += p.hat[j] * g[i] * rho[i];
    }
  }
  for (std::size_t k = 0; k < bins.mean.size(); ++k)
    if (bins.weight[k] > 0) bins.mean[k] /= bins.weight[k];
  return bins;
}

double slice_bins(const ChromaBins& bins, double c0, double c1) {
  const GridPoint p = grid_point(c0, c1);
  double sum = 0;
  for (std::size_t j = 0; j < 4; ++j) sum += p.hat[j] * bins.mean[p.at[j]];
  return sum;
}

IntrinsicResult decompose(const double* rgb, int width, int height, const IntrinsicParams& params,
                          IntrinsicState* state) {
  const Guide guide = make_guide(rgb, width, height, params.light);
  EdgePrior prior = edge_prior(guide, params);
  if (params.strokes) apply_strokes(guide, *params.strokes, prior);
  const GuideLevel &l = guide.level[0], &cells = guide.level[kCellLevel];
  const std::size_t n = l.m.size(), w = std::size_t(width), cell_count = cells.m.size();
  IntrinsicResult result;

  // Cell terms; and the temporal anchor, a term of the pixels of one weight in a cell.
  struct {
    std::vector<double> screening, data, g;  // v + g, v V, g
  } terms{std::vector<double>(cell_count), std::vector<double>(cell_count), prior.g};
  for (std::size_t i = 0; i < cell_count; ++i) {
    terms.screening[i] = prior.v[i] + prior.g[i];
    terms.data[i] = prior.v[i] * prior.V[i];
  }
  const std::vector<double> detail = detail_of(guide);
  Gate gate;
  if (state && state->width == width && state->height == height && !state->rho.empty() &&
      params.anchor_weight > 0) {
    gate = temporal_gate(guide, detail, *state, params);
    result.stats.mismatch = gate.mismatch;
    const bool sudden = state->frames >= 4 &&
                        gate.mismatch >= std::max(params.cut_fraction / 6, 8 * state->expected);
    result.stats.anchored = gate.mismatch < params.cut_fraction && !sudden;
  }

  multigrid::Level fine(width, height);
  for (std::size_t i = 0; i < n; ++i) {
    fine.mass[i] = kMinDiagonal;
    fine.right[i] = prior.a_right[i] + prior.b_right[i];
    fine.down[i] = prior.a_down[i] + prior.b_down[i];
    const std::size_t x = i % w;
    if (x + 1 < w) {
      const double step = prior.a_right[i] * (l.m[i] - l.m[i + 1]);
      fine.f[i] += step, fine.f[i + 1] -= step;
    }
    if (i + w < n) {
      const double step = prior.a_down[i] * (l.m[i] - l.m[i + w]);
      fine.f[i] += step, fine.f[i + w] -= step;
    }
  }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = l.index(x, y), c = cells.index(x >> kCellLevel, y >> kCellLevel);
      const bool anchored = result.stats.anchored;
      const double value =
          (anchored ? prior.V[c] + gate.alike[c] * (state->coarse[c] - prior.V[c]) : prior.V[c]) +
          l.m[i] + l.u[i] - cells.m[c] - cells.u[c];
      fine.s[i] = value;
      if (!anchored) continue;
      const double before = l.m[i] - state->m[i] + state->s[i];
      const double anchor = gate.value[c] * params.anchor_weight *
                            std::min(1.0, (state->frames + 1) / params.anchor_frames);
      fine.mass[i] += anchor;
      fine.f[i] += anchor * before;
      fine.s[i] += gate.value[c] * (before - value);
    }
  std::vector<multigrid::Level> levels = multigrid::hierarchy(fine, terms.screening, kCoarseScale);

  // Targets of the cells at the bins' present means, and the source terms from them.
  std::vector<double> target(cell_count), rho(cell_count), coarse(cell_count);
  const multigrid::CellTerms cell_terms{
      [&](const std::vector<double>& far, const std::vector<double>& means,
          multigrid::Level& level) {
        for (std::size_t i = 0; i < cell_count; ++i) rho[i] = cells.m[i] - means[i] - level.s[i];
        const ChromaBins bins = splat_bins(cells, terms.g, rho);
        for (std::size_t i = 0; i < cell_count; ++i) {
          target[i] = terms.data[i] +
                      terms.g[i] * (cells.m[i] - slice_bins(bins, cells.c0[i], cells.c1[i]));
          level.f[i] = far[i] + target[i] - terms.screening[i] * means[i];
        }
      },
      [&](const std::vector<double>& means, const multigrid::Level& level) {
        std::vector<double> source(cell_count);
        for (std::size_t i = 0; i < cell_count; ++i) {
          coarse[i] = means[i] + level.s[i];
          source[i] = target[i] - terms.screening[i] * coarse[i];
        }
        return source;
      }};
  std::vector<double> source(cell_count, 0.0);
  if (result.stats.anchored)
    for (std::size_t i = 0; i < cell_count; ++i) source[i] = gate.value[i] * state->source[i];
  // A single cycle cannot be combined.
  multigrid::Extrapolation extrapolation(params.cycles > 1 ? params.slowest : 0);
  for (int k = 0; k < params.cycles; ++k) {
    const std::vector<double> before = levels[0].s;
    multigrid::cycle(levels, params.cell_cycles, cell_terms, terms.screening, source);
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += square(levels[0].s[i] - before[i]);
    result.stats.change.push_back(std::sqrt(sum / double(n)));
    extrapolation.apply(k, before, levels[0].s);
  }

  // Where nothing moves, reflectance changes only partly from the frame before.
  std::vector<double>& s = levels[0].s;
  if (result.stats.anchored) {
    std::vector<double> hold(cell_count);
    for (std::size_t c = 0; c < cell_count; ++c)
      hold[c] = gate.value[c] * params.hold /
                (1 + square((cells.m[c] - state->mean[c]) / params.hold_light));
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const std::size_t i = l.index(x, y), c = cells.index(x >> kCellLevel, y >> kCellLevel);
        const double off = l.m[i] - state->m[i] - (cells.m[c] - state->mean[c]);
        s[i] += between_cells(hold, cells, x, y) / (1 + square(off / params.hold_texture)) *
                (brightness(rgb, i) - state->rho[i] - s[i]);
      }
  }

  // Layers and state.
  result.log_shading = s;
  result.reflectance.resize(3 * n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::array<double, 3> color = light_color(params.light, s[i] - params.light.white);
    for (std::size_t c = 0; c < 3; ++c)
      result.reflectance[3 * i + c] = sanitize_linear(rgb[3 * i + c]) * std::exp(-s[i]) / color[c];
  }
  if (state) {
    const int frames = result.stats.anchored ? state->frames + 1 : 0;
    *state = {width,
              height,
              detail,
              cells.c0,
              cells.c1,
              cells.m,
              source,
              coarse,
              l.m,
              s,
              std::vector<double>(n),
              frames,
              result.stats.anchored ? std::max(gate.mismatch, 0.9 * state->expected) : 0};
    for (std::size_t i = 0; i < n; ++i) state->rho[i] = brightness(rgb, i) - s[i];
  }
  return result;
}

}  // namespace inverse::reference
