#include "global_intrinsic.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace inverse::reference {
namespace {

using namespace global;

/// What the small grid decides about a frame.
struct Scene {
  Scene(Grid points, const PaletteParams& palette)
      : grid(std::move(points)), histogram(palette.bins, palette.bin_width) {}
  Grid grid;
  std::vector<int> labels;
  std::vector<Vec3> received;  // E0
  std::vector<Chroma> tint;
  std::vector<double> fraction, weight;
  AmountCost cost{};
  Amount amount;
  ChromaHistogram histogram;
  BaseColors colors;
  TintStatistics statistics;
};

Vec3 scaled(double f, const Vec3& v) { return {f * v[0], f * v[1], f * v[2]}; }

/// Labels of the grid's points by what chroma the last known tint leaves.
std::vector<int> labels_of(const Grid& grid, const std::vector<Chroma>& tint,
                           const BaseColors& colors, const ChromaHistogram& histogram) {
  std::vector<int> labels(grid.size(), 0);
  if (colors.label.empty()) return labels;
  for (std::size_t i = 0; i < grid.size(); ++i)
    labels[i] = colors.label[histogram.nearest(grid.chroma[i] - tint[i])];
  return labels;
}

/// Gathers light, and finds its tint with a given or newly measured amount.
Gather gather_light(Scene& scene, const GlobalParams& params) {
  Gather gather(scene.grid, scene.labels, int(params.palette.most), params.gather);
  scene.received.resize(scene.grid.size());
  for (int y = 0; y < scene.grid.height; ++y)
    for (int x = 0; x < scene.grid.width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(scene.grid.width) + std::size_t(x);
      scene.received[i] = gather.received(scene.labels[i], x, y, 2);
    }
  return gather;
}

void find_tint(Scene& scene, const GlobalParams& params) {
  const std::size_t n = scene.grid.size();
  scene.tint.resize(n), scene.fraction.resize(n), scene.weight.resize(n);
  double mean_weight = 1e-9;
  for (const double w : scene.grid.weight) mean_weight += w / double(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 light = scaled(scene.amount.value, scene.received[i]);
    scene.tint[i] = tint_of(scene.grid.shading[i], light);
    scene.fraction[i] = split(scene.grid.shading[i], light).fraction;
    const double trust = 1 + 9 * scene.fraction[i] * scene.fraction[i];
    scene.weight[i] = (0.5 + 0.5 * scene.grid.weight[i] / mean_weight) / trust;
  }
  scene.statistics = tint_statistics(scene.tint, scene.fraction, scene.weight, params.tint);
}

/// Base colors of the frame's chroma without tint, the histogram mixed with that of before.
void find_colors(Scene& scene, const std::vector<double>& before, const GlobalParams& params) {
  ChromaHistogram now(params.palette.bins, params.palette.bin_width);
  for (std::size_t i = 0; i < scene.grid.size(); ++i)
    now.add(scene.grid.chroma[i] - scene.tint[i], scene.weight[i]);
  if (before.size() == now.values().size()) {
    const double scale = 1 / std::max(now.total(), 1e-9);
    for (std::size_t b = 0; b < before.size(); ++b)
      now.values()[b] = params.palette.renew * scale * now.values()[b] +
                        (1 - params.palette.renew) * before[b];
  }
  const double scale = 1 / std::max(now.total(), 1e-9);
  for (double& v : now.values()) v *= scale;
  scene.histogram = now;
  scene.colors = find_modes(scene.histogram, scene.colors, params.palette);
}

bool one_color(const BaseColors& colors) { return colors.used() == 1; }

Scene look_at(const std::vector<double>& rgb, const std::vector<double>& shading, int width,
              int height, const GlobalParams& params, const GlobalState* state,
              std::vector<Gather>& gathered) {
  const int factor = grid_factor(width, height, params.grid);
  Scene scene(make_grid(rgb, shading, width, height, factor), params.palette);
  const bool warm = state && state->known && state->tint.size() == scene.grid.size();
  if (warm) scene.colors = state->colors, scene.tint = state->tint;
  scene.tint.resize(scene.grid.size(), Chroma{});
  for (int round = warm ? 1 : 0; round < 2; ++round) {
    scene.labels = labels_of(scene.grid, scene.tint, scene.colors, scene.histogram);
    gather_light(scene, params);
    scene.cost = amount_cost(scene.grid, scene.received, params.amount);
    if (warm)
      for (std::size_t k = 0; k < kCandidates; ++k)
        scene.cost[k] = params.amount.renew * scene.cost[k] +
                        (1 - params.amount.renew) * state->cost[k];
    scene.amount = amount_of(scene.cost, params.amount);
    find_tint(scene, params);
    find_colors(scene, warm ? state->histogram : std::vector<double>(), params);
  }
  scene.labels = labels_of(scene.grid, scene.tint, scene.colors, scene.histogram);
  if (params.merge) {
    merge_shaded(scene.colors, scene.labels, scene.fraction, scene.weight, scene.statistics.full,
                 params.palette);
    scene.labels = labels_of(scene.grid, scene.tint, scene.colors, scene.histogram);
  }
  gathered.push_back(gather_light(scene, params));
  find_tint(scene, params);
  return scene;
}

Chroma blend(const std::vector<Chroma>& plane, const Grid& grid, int x, int y) {
  const Between u = between(x, grid.factor, grid.width), v = between(y, grid.factor, grid.height);
  const auto at = [&](std::size_t row, std::size_t column) {
    return plane[row * std::size_t(grid.width) + column];
  };
  return (1 - v.share) * ((1 - u.share) * at(v.low, u.low) + u.share * at(v.low, u.high)) +
         v.share * ((1 - u.share) * at(v.high, u.low) + u.share * at(v.high, u.high));
}

}  // namespace

GlobalResult decompose_global(const double* input, int width, int height,
                              const GlobalParams& params, GlobalState* state) {
  const std::size_t n = std::size_t(width) * std::size_t(height);
  std::vector<double> rgb(3 * n);
  for (std::size_t i = 0; i < 3 * n; ++i) rgb[i] = sanitize_linear(input[i]);
  GlobalResult result;

  // How bright the light is, as far as known before.
  std::vector<double> guess(n);
  const bool warm = state && state->known && state->solve.width == width &&
                    state->solve.height == height && state->solve.s.size() == n;
  if (warm) {
    for (std::size_t i = 0; i < n; ++i) {
      double m = 0;
      for (std::size_t c = 0; c < 3; ++c) m += std::log(rgb[3 * i + c] + kIntensityFloor) / 3;
      guess[i] = m - state->solve.m[i] + state->solve.s[i];
    }
  } else {
    guess = decompose(rgb.data(), width, height, params.solve, nullptr).log_shading;
  }
  const double scale = warm ? state->log_scale
                            : OutputGauge(params.gauge).update(make_guide(rgb.data(), width, height),
                                                               guess, false);
  std::vector<double> shading(n);
  for (std::size_t i = 0; i < n; ++i) shading[i] = std::exp(guess[i] - scale);

  std::vector<Gather> gathered;
  const Scene scene = look_at(rgb, shading, width, height, params, warm ? state : nullptr, gathered);
  const Gather& gather = gathered.back();
  const bool gray = one_color(scene.colors);

  // Residual on the grid.
  std::vector<Chroma> raw(scene.grid.size());
  for (std::size_t i = 0; i < raw.size(); ++i)
    raw[i] = scene.grid.chroma[i] - scene.tint[i] -
             *scene.colors.color[std::size_t(scene.labels[i])];
  const Residual residual = residual_field(raw, scene.fraction, scene.grid.width,
                                           scene.grid.height, scene.statistics, params.tint);

  // Tint of every pixel.
  std::vector<Chroma> tau(n);
  std::vector<Vec3> indirect(n);
  std::vector<double> plain(3 * n);
  result.label.resize(n);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x);
      const Chroma z = chroma_of({rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]});
      const int label =
          scene.colors.label[scene.histogram.nearest(z - blend(scene.tint, scene.grid, x, y))];
      result.label[i] = label;
      Vec3 light =
          scaled(scene.amount.value, gather.received(label, x, y, 2 * scene.grid.factor));
      if (gray) light = Vec3{mean(light), mean(light), mean(light)};
      indirect[i] = light;
      if (!gray) {
        const Chroma t = tint_of(shading[i], light);
        const double fraction = split(shading[i], light).fraction;
        Chroma e = z - t - *scene.colors.color[std::size_t(label)];
        const double c = belief(e, fraction, scene.statistics, params.tint);
        e = c * e + (1 - c) * blend(residual.smooth, scene.grid, x, y);
        const Chroma a = blend(residual.slope, scene.grid, x, y),
                     b = blend(residual.offset, scene.grid, x, y);
        const double share = scene.statistics.gate * std::min(1.0, 3 * fraction);
        tau[i] = t + share * Chroma{a[0] * e[0] + b[0], a[1] * e[1] + b[1]};
      }
      const Vec3 color = color_of(tau[i]);
      for (std::size_t k = 0; k < 3; ++k)
        plain[3 * i + k] = rgb[3 * i + k] / std::max(color[k], 0.02);
    }

  // How bright it is.
  IntrinsicParams solve = params.solve;
  if (warm) solve.cycles = params.warm_cycles;
  IntrinsicResult plain_result =
      decompose(plain.data(), width, height, solve, state ? &state->solve : nullptr);
  result.stats = plain_result.stats;
  OutputGauge still(params.gauge);
  OutputGauge& output = state ? state->gauge : still;
  const double log_scale = output.update(make_guide(plain.data(), width, height),
                                         plain_result.log_shading, result.stats.anchored);
  if (state) state->log_scale = log_scale;

  // Layers.
  double now = 1e-12, before = 1e-12;
  for (std::size_t i = 0; i < n; ++i) {
    now += std::exp(plain_result.log_shading[i] - log_scale);
    before += shading[i];
  }
  const double gauge = now / before;
  result.reflectance.resize(3 * n), result.indirect.resize(3 * n), result.direct.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double s = std::exp(plain_result.log_shading[i] - log_scale);
    const Vec3 light = scaled(s, color_of(tau[i]));
    const double t0 = std::min(split(mean(light), scaled(gauge, indirect[i])).direct,
                               *std::min_element(light.begin(), light.end()));
    result.direct[i] = t0;
    for (std::size_t c = 0; c < 3; ++c) {
      result.indirect[3 * i + c] = light[c] - t0;
      result.reflectance[3 * i + c] = rgb[3 * i + c] / std::max(light[c], 1e-9);
    }
  }
  result.colors = scene.colors;
  result.amount = scene.amount;
  result.cost = scene.cost;
  result.tint = scene.statistics.full;
  if (state) {
    state->histogram = scene.histogram.values();
    state->cost = scene.cost;
    state->colors = scene.colors;
    state->tint = scene.tint;
    state->full = scene.statistics.full;
    state->known = true;
  }
  return result;
}

}  // namespace inverse::reference
