// SPDX-License-Identifier: LGPL-2.1-or-later
#include "strokes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "intrinsic_decomposition.hpp"
#include "multigrid.hpp"

namespace inverse::reference {
namespace {

/// Of each cell, the stroke that covers most of it and the share that it covers.
struct CellStrokes {
  std::vector<int> stroke;
  std::vector<double> share;
};

CellStrokes cell_strokes(const Guide& guide, const StrokeMask& mask) {
  const GuideLevel& cells = guide.level[kCellLevel];
  CellStrokes result{std::vector<int>(cells.m.size(), -1), std::vector<double>(cells.m.size(), 0)};
  for (std::size_t k = 0; k < mask.kinds.size(); ++k) {
    std::vector<double> share(mask.stroke.size(), 0.0);
    for (std::size_t i = 0; i < share.size(); ++i)
      if (mask.stroke[i] == static_cast<int>(k)) share[i] = mask.weight[i];
    for (int level = 0; level < kCellLevel; ++level)
      share = multigrid::halve(share, guide.level[static_cast<std::size_t>(level)].width,
                               guide.level[static_cast<std::size_t>(level)].height);
    for (std::size_t i = 0; i < share.size(); ++i)
      if (share[i] > result.share[i]) {
        result.share[i] = share[i];
        result.stroke[i] = static_cast<int>(k);
      }
  }
  return result;
}

}  // namespace

void fill_strokes(const std::vector<bool>& filled, const double* rgb, int width, StrokeMask& mask) {
  const std::size_t n = mask.stroke.size(), w = static_cast<std::size_t>(width);
  struct Mean {
    double rgb[3] = {}, weight = 0;
  };
  std::vector<Mean> means(mask.kinds.size());
  for (std::size_t i = 0; i < n; ++i) {
    if (mask.stroke[i] < 0) continue;
    Mean& mean = means[static_cast<std::size_t>(mask.stroke[i])];
    for (std::size_t c = 0; c < 3; ++c) mean.rgb[c] += mask.weight[i] * rgb[3 * i + c];
    mean.weight += mask.weight[i];
  }
  std::vector<int> label(n, -1);
  std::vector<double> distance(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    if (mask.stroke[i] >= 0) {
      if (filled[static_cast<std::size_t>(mask.stroke[i])]) label[i] = mask.stroke[i];
      continue;
    }
    distance[i] = kFillDistance;
    for (std::size_t k = 0; k < means.size(); ++k) {
      if (!filled[k] || !(means[k].weight > 0)) continue;
      double squares = 0;
      for (std::size_t c = 0; c < 3; ++c)
        squares += std::pow(rgb[3 * i + c] - means[k].rgb[c] / means[k].weight, 2);
      if (std::sqrt(squares) >= distance[i]) continue;
      distance[i] = std::sqrt(squares);
      label[i] = static_cast<int>(k);
    }
  }
  std::vector<std::size_t> front;
  std::vector<bool> reached(n, false);
  for (std::size_t i = 0; i < n; ++i)
    if (mask.stroke[i] >= 0 && label[i] >= 0) {
      reached[i] = true;
      front.push_back(i);
    }
  while (!front.empty()) {
    const std::size_t i = front.back(), x = i % w;
    front.pop_back();
    const auto visit = [&](std::size_t j) {
      if (reached[j] || label[j] != label[i]) return;
      reached[j] = true;
      front.push_back(j);
    };
    if (x > 0) visit(i - 1);
    if (x + 1 < w) visit(i + 1);
    if (i >= w) visit(i - w);
    if (i + w < n) visit(i + w);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!reached[i] || mask.stroke[i] >= 0) continue;
    mask.stroke[i] = label[i];
    mask.weight[i] = std::pow(std::min(1.0, 2 * (1 - distance[i] / kFillDistance)), 2);
  }
}

void apply_strokes(const Guide& guide, const StrokeMask& mask, EdgePrior& prior) {
  const GuideLevel &l = guide.level[0], &cells = guide.level[kCellLevel];
  const auto edge = [&](std::size_t p, std::size_t q, double& a, double& b) {
    if (mask.stroke[p] < 0 || mask.stroke[p] != mask.stroke[q]) return;
    const double w = std::min(mask.weight[p], mask.weight[q]);
    const double all = a + b + kStrokeWeight;
    const bool shading =
        mask.kinds[static_cast<std::size_t>(mask.stroke[p])] == StrokeKind::shading;
    a = (1 - w) * a + (shading ? 0 : w * all);
    b = (1 - w) * b + (shading ? w * all : 0);
  };
  for (int y = 0; y < l.height; ++y)
    for (int x = 0; x < l.width; ++x) {
      const std::size_t i = l.index(x, y);
      if (x + 1 < l.width) edge(i, l.index(x + 1, y), prior.a_right[i], prior.b_right[i]);
      if (y + 1 < l.height) edge(i, l.index(x, y + 1), prior.a_down[i], prior.b_down[i]);
    }

  const CellStrokes of = cell_strokes(guide, mask);
  const auto base = [&](std::size_t cell) {
    return mask.kinds[static_cast<std::size_t>(of.stroke[cell])] == StrokeKind::shading
               ? 0
               : cells.m[cell];
  };
  std::vector<double> sum(mask.kinds.size(), 0.0), weight(sum);
  for (std::size_t i = 0; i < of.stroke.size(); ++i) {
    if (of.stroke[i] < 0) continue;
    const auto k = static_cast<std::size_t>(of.stroke[i]);
    sum[k] += of.share[i] * prior.v[i] * (prior.V[i] - base(i));
    weight[k] += of.share[i] * prior.v[i];
  }
  for (std::size_t i = 0; i < of.stroke.size(); ++i) {
    if (of.stroke[i] < 0) continue;
    const auto k = static_cast<std::size_t>(of.stroke[i]);
    const double c = of.share[i];
    prior.V[i] = (1 - c) * prior.V[i] + c * (base(i) + sum[k] / weight[k]);
    prior.g[i] *= 1 - c;
  }
}

}  // namespace inverse::reference
