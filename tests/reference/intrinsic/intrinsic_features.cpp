// SPDX-License-Identifier: LGPL-2.1-or-later
#include "intrinsic_features.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

constexpr double kChromaFloor = 1e-2;
// (c0, c1) are axes of one scale in the plane of chroma: a distance there is the same whatever the
// channels are called.
constexpr double kChromaScale = 0.86602540378;  // √3/2

}  // namespace

double sanitize_linear(double v) {
  if (std::isnan(v) || v < 0) return 0;
  return std::min(v, 1e4);
}

namespace {

double log_cue(double v, double center) { return (std::log(v + 0.01) + center) / 1.5; }

double chroma_distance(const GuideLevel& a, std::size_t i, const GuideLevel& b, std::size_t j) {
  return std::hypot(a.c0[i] - b.c0[j], a.c1[i] - b.c1[j]);
}

double chroma_step(const GuideLevel& l, std::size_t i, std::size_t j) {
  return std::hypot(l.c0[i] - l.c0[j], l.c1[i] - l.c1[j]);
}

/// Numbers that say what kind of frame this is, from guide level 1. Dark pixels count little.
void frame_statistics(Guide& g, double slope) {
  const GuideLevel& l = g.level[1];
  double sum = 0, weight = 1e-6, excess = 0;
  double step = 0.02 * 0.1, even = 0, chromatic = 0.02;  // over chroma edges
  double plain = 0, achromatic = 1e-6;                   // over the others
  const auto trust = [&](std::size_t i) {
    const double intensity = std::exp(l.m[i]);
    return intensity / (intensity + 0.02);
  };
  for (int y = 0; y < l.height; ++y)
    for (int x = 0; x < l.width; ++x) {
      const std::size_t i = l.index(x, y);
      const double t = trust(i);
      sum += t * l.m[i];
      excess += t * l.u[i];
      weight += t;
      for (const std::size_t j : {l.index(x + 1, y), l.index(x, y + 1)}) {
        if (j == i) continue;  // the border
        const double dc = std::min(chroma_step(l, i, j), 0.3), tt = t * trust(j);
        const double dv = std::abs(l.m[i] + l.u[i] - l.m[j] - l.u[j]), w = tt * dc * dc;
        step += w * dv;
        even += w * 0.1 / (0.1 + dv);
        chromatic += w;
        const double a = tt * 0.05 / (0.05 + dc);
        plain += a * std::min(std::abs(l.m[i] - l.m[j]), 1.0);
        achromatic += a;
      }
    }
  g.mean = sum / weight;
  g.statistics = {std::log(step / chromatic + 0.01) + 2, 4 * even / chromatic - 2,
                  5 * excess / weight - 1.5, std::log(plain / achromatic + 0.003) + 3,
                  std::min(std::abs(slope), 1.0)};
}

}  // namespace

GuideLevel halve(const GuideLevel& f) {
  GuideLevel c;
  c.width = (f.width + 1) / 2, c.height = (f.height + 1) / 2;
  const auto mean = [&](const std::vector<double>& in) {
    std::vector<double> out(std::size_t(c.width) * c.height);
    for (int y = 0; y < c.height; ++y)
      for (int x = 0; x < c.width; ++x)
        out[std::size_t(y) * c.width + x] =
            0.25 * (in[f.index(2 * x, 2 * y)] + in[f.index(2 * x + 1, 2 * y)] +
                    in[f.index(2 * x, 2 * y + 1)] + in[f.index(2 * x + 1, 2 * y + 1)]);
    return out;
  };
  c.m = mean(f.m), c.c0 = mean(f.c0), c.c1 = mean(f.c1), c.u = mean(f.u);
  c.gm = mean(f.gm), c.gc = mean(f.gc);
  return c;
}

std::size_t GuideLevel::index(int x, int y) const {
  return std::size_t(std::clamp(y, 0, height - 1)) * std::size_t(width) +
         std::size_t(std::clamp(x, 0, width - 1));
}

std::array<double, 3> in_white_light(const std::array<double, 3>& rgb, const LightColor& light) {
  double m = 0;
  for (const double v : rgb) m += std::log(v + kIntensityFloor) / 3;
  std::array<double, 3> white = light_color(light, m - light.reference);
  for (std::size_t c = 0; c < 3; ++c) white[c] = rgb[c] / white[c];
  return white;
}

Guide make_guide(const double* rgb, int width, int height, const LightColor& light) {
  Guide g;
  GuideLevel& l = g.level[0];
  l.width = width, l.height = height;
  const std::size_t n = std::size_t(width) * height;
  for (auto* plane : {&l.m, &l.c0, &l.c1, &l.u, &l.gm, &l.gc}) plane->resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::array<double, 3> v{}, f{}, k{};
    for (std::size_t c = 0; c < 3; ++c) v[c] = sanitize_linear(rgb[3 * i + c]);
    for (const double c : v) l.m[i] += std::log(c + kIntensityFloor) / 3;
    v = in_white_light(v, light);
    for (std::size_t c = 0; c < 3; ++c) {
      f[c] = std::log(v[c] + kIntensityFloor);
      k[c] = std::log(v[c] + kChromaFloor);
    }
    l.u[i] = std::max({f[0], f[1], f[2]}) - l.m[i];
    l.c0[i] = kChromaScale * (k[0] - k[1]);
    l.c1[i] = 0.5 * (k[0] + k[1]) - k[2];
  }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = l.index(x, y);
      for (const std::size_t j :
           {l.index(x - 1, y), l.index(x + 1, y), l.index(x, y - 1), l.index(x, y + 1)}) {
        l.gm[i] += 0.5 * std::abs(l.m[i] - l.m[j]);
        l.gc[i] += 0.5 * chroma_step(l, i, j);
      }
    }
  for (std::size_t k = 1; k < kGuideLevels; ++k) g.level[k] = halve(g.level[k - 1]);
  frame_statistics(g, light.slope);
  return g;
}

void edge_features(const Guide& g, int x, int y, bool down, double* out) {
  const GuideLevel &l0 = g.level[0], &l1 = g.level[1], &l2 = g.level[2];
  const auto cell = [&](const GuideLevel& l, int offset, int shift) {
    return down ? l.index(x >> shift, (y + offset) >> shift)
                : l.index((x + offset) >> shift, y >> shift);
  };
  const auto clamped = [&](int offset) {  // keeps negative positions out of the shifts
    return std::max(offset, down ? -y : -x);
  };
  const std::size_t p = cell(l0, 0, 0), q = cell(l0, 1, 0);
  const std::size_t before = cell(l0, -1, 0), after = cell(l0, 2, 0);
  const std::size_t p1 = cell(l1, clamped(-1), 1), q1 = cell(l1, 2, 1);
  const std::size_t p2 = cell(l2, clamped(-3), 2), q2 = cell(l2, 4, 2);
  const double dm = std::abs(l0.m[p] - l0.m[q]), dm1 = std::abs(l1.m[p1] - l1.m[q1]);
  out[0] = log_cue(dm, 3);
  out[1] = log_cue(chroma_step(l0, p, q), 3);
  out[2] = log_cue(dm1, 2.5);
  out[3] = log_cue(chroma_step(l1, p1, q1), 2.5);
  out[4] = log_cue(std::abs(l2.m[p2] - l2.m[q2]), 2);
  out[5] = log_cue(chroma_step(l2, p2, q2), 2);
  out[6] = log_cue(0.5 * (l2.gm[p2] + l2.gm[q2]), 2.5);
  out[7] = log_cue(0.5 * (l2.gc[p2] + l2.gc[q2]), 2.5);
  out[8] = std::clamp((0.5 * (l0.m[p] + l0.m[q]) - g.mean) / 1.5, -2.0, 2.0);
  out[9] = (l0.u[p] + l0.u[q]) - 0.7;
  out[10] = 5 * std::clamp(std::abs(l0.m[p] + l0.u[p] - l0.m[q] - l0.u[q]) - dm, -0.4, 0.4);
  out[12] = log_cue(std::abs(l0.m[before] - l0.m[p]) + std::abs(l0.m[q] - l0.m[after]), 3);
  out[13] = log_cue(chroma_step(l0, before, p) + chroma_step(l0, q, after), 3);
  out[14] = std::clamp(0.5 * (std::min(l0.m[p], l0.m[q]) + 4), -1.0, 2.0);
  out[11] = 5 * std::clamp(std::abs(l1.m[p1] + l1.u[p1] - l1.m[q1] - l1.u[q1]) - dm1, -0.4, 0.4);
  std::copy(g.statistics.begin(), g.statistics.end(), out + kEdgeFeatures - kFrameStatistics);
}

void cell_features(const Guide& g, int x, int y, double* out) {
  const GuideLevel &l2 = g.level[kCellLevel], &l4 = g.level[kCellLevel + 2];
  const std::size_t p = l2.index(x, y), q = l4.index(x >> 2, y >> 2);
  out[0] = 2 * l2.u[p] - 0.7;
  out[1] = std::clamp((l2.m[p] - g.mean) / 1.5, -2.0, 2.0);
  out[2] = std::clamp(0.5 * (l2.m[p] + 4), -1.0, 2.0);
  out[3] = log_cue(l2.gm[p], 2.5);
  out[4] = log_cue(l2.gc[p], 2.5);
  out[5] = std::clamp(l2.m[p] + l2.u[p] - l4.m[q] - l4.u[q], -2.0, 2.0);
  out[6] = log_cue(chroma_distance(l2, p, l4, q), 2);
  std::copy(g.statistics.begin(), g.statistics.end(), out + kCellFeatures - kFrameStatistics);
}

}  // namespace inverse::reference
