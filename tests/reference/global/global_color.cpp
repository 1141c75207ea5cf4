// SPDX-License-Identifier: LGPL-2.1-or-later
#include "global_color.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference::global {
namespace {

const double kU = 1 / std::sqrt(2.0), kV = 1 / std::sqrt(6.0);
constexpr double kDark = 0.01, kBright = 0.98;

}  // namespace

double mean(const Vec3& color) { return (color[0] + color[1] + color[2]) / 3; }
double norm2(const Chroma& c) { return c[0] * c[0] + c[1] * c[1]; }
Chroma operator+(const Chroma& a, const Chroma& b) { return {a[0] + b[0], a[1] + b[1]}; }
Chroma operator-(const Chroma& a, const Chroma& b) { return {a[0] - b[0], a[1] - b[1]}; }
Chroma operator*(double f, const Chroma& c) { return {f * c[0], f * c[1]}; }

Chroma chroma_of(const Vec3& color) {
  const double r = std::log(color[0] + kChromaFloor), g = std::log(color[1] + kChromaFloor),
               b = std::log(color[2] + kChromaFloor);
  return {kU * (r - g), kV * (r + g - 2 * b)};
}

Vec3 color_of(const Chroma& c) {
  const double u = kU * c[0], v = kV * c[1];
  return {std::exp(u + v), std::exp(v - u), std::exp(-2 * v)};
}

Split split(double shading, const Vec3& indirect) {
  const double all = mean(indirect);
  const double k = all > shading ? shading / all : 1.0;
  Split out;
  for (std::size_t c = 0; c < 3; ++c) out.indirect[c] = k * indirect[c];
  out.direct = std::max(0.0, shading - k * all);
  out.fraction = std::min(1.0, all / std::max(shading, 1e-6));
  return out;
}

PixelLight compose(double exp_s, const Vec3& tau, const Vec3& gathered) {
  Vec3 light = tau;
  for (double& v : light) v *= exp_s;
  PixelLight out;
  out.direct =
      std::min(split(mean(light), gathered).direct, *std::min_element(light.begin(), light.end()));
  for (std::size_t c = 0; c < 3; ++c) out.indirect[c] = light[c] - out.direct;
  return out;
}

Chroma tint_of(double shading, const Vec3& indirect) {
  const Split s = split(shading, indirect);
  return chroma_of({s.direct + s.indirect[0], s.direct + s.indirect[1], s.direct + s.indirect[2]});
}

int grid_factor(int width, int height, int largest) {
  int factor = 1;
  while ((std::max(width, height) + factor - 1) / factor > largest) factor *= 2;
  return factor;
}

Grid make_grid(const std::vector<double>& rgb, const std::vector<double>& shading, int width,
               int height, int factor) {
  Grid g;
  g.factor = factor;
  g.width = (width + factor - 1) / factor, g.height = (height + factor - 1) / factor;
  const std::size_t n = std::size_t(g.width) * std::size_t(g.height);
  g.color.assign(n, Vec3{}), g.shading.assign(n, 0.0);
  std::vector<double> count(n, 0.0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x);
      const std::size_t j =
          std::size_t(y / factor) * std::size_t(g.width) + std::size_t(x / factor);
      for (std::size_t c = 0; c < 3; ++c) g.color[j][c] += rgb[3 * i + c];
      g.shading[j] += shading[i];
      count[j] += 1;
    }
  for (std::size_t j = 0; j < n; ++j) {
    for (double& v : g.color[j]) v /= count[j];
    g.shading[j] /= count[j];
    const double light = mean(g.color[j]);
    const bool fair =
        light > kDark && *std::max_element(g.color[j].begin(), g.color[j].end()) < kBright;
    g.weight.push_back(fair ? light : 0);
    g.chroma.push_back(chroma_of(g.color[j]));
  }
  return g;
}

Chroma illuminant(const Grid& grid) {
  constexpr double kPower = 6;
  Vec3 sum{};
  for (std::size_t i = 0; i < grid.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      if (grid.weight[i] > 0) sum[c] += std::pow(grid.color[i][c], kPower) / double(grid.size());
  for (double& v : sum) v = std::pow(v, 1 / kPower);
  return chroma_of(sum);
}

Between between(int x, int factor, int count) {
  const double at = std::clamp((x + 0.5) / factor - 0.5, 0.0, double(count - 1));
  const auto low = std::size_t(at);
  return {low, std::min(low + 1, std::size_t(count - 1)), at - double(low)};
}

}  // namespace inverse::reference::global
