// SPDX-License-Identifier: LGPL-2.1-or-later
#include "global_intrinsic.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

using namespace global;

Vec3 color_at(const std::vector<double>& rgb, std::size_t i) {
  return {rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]};
}

constexpr double kMinTau = 0.02;      // of a channel
constexpr double kMaxLight = 1e4;     // that the solve takes
constexpr double kRenewColor = 0.05;  // share of the newest frame in whether light has color

/// Result of one analysis of the grid.
struct Analysis {
  std::vector<int> labels;
  BaseColors colors;
  Gather gather;
  Amount amount;
  std::vector<Chroma> tint;
  std::vector<double> fraction;
  TintStatistics statistics;
};

ChromaHistogram empty_histogram(const PaletteParams& p) { return {p.bins, p.bin_width}; }

/// Received light times the amount, with its color weighted by its confidence.
Vec3 indirect_of(const Amount& amount, const Vec3& received) {
  Vec3 light;
  for (std::size_t c = 0; c < 3; ++c)
    light[c] = amount.value * (mean(received) + amount.color * (received[c] - mean(received)));
  return light;
}

/// Gathers the light from surfaces of the last frame's base colors, estimates its amount and tint,
/// then finds the frame's own base colors. This frame has weight `renew` in cost and histogram.
Analysis analyze(const Grid& grid, const GlobalParams& params, double renew, double spread,
                 GlobalScene& scene) {
  const std::size_t n = grid.size();
  scene.labels.resize(n, 0);
  std::vector<int>& labels = scene.labels;
  Analysis out;
  out.gather = Gather(grid, labels, params.palette.most, params.gather);
  std::vector<Vec3> received(n);
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(grid.width) + std::size_t(x);
      received[i] = out.gather.received(labels[i], x, y, 2);
    }

  const AmountCost cost = amount_cost(grid, received, params.amount);
  for (std::size_t k = 0; k < cost.size(); ++k) scene.cost[k] += renew * (cost[k] - scene.cost[k]);
  out.amount = amount_of(scene.cost, spread, params.amount);
  const double share =
      params.amount.manual > 0 ? 1 : std::max(kRenewColor, 1.0 / (scene.frames + 1));
  scene.color += share * (out.amount.color - scene.color);
  out.amount.color = scene.color;

  double mean_weight = 1e-9;
  for (const double w : grid.weight) mean_weight += w / double(n);
  std::vector<double> weight(n);
  out.tint.resize(n), out.fraction.resize(n);
  ChromaHistogram now = empty_histogram(params.palette);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 light = indirect_of(out.amount, received[i]);
    out.tint[i] = tint_of(grid.shading[i], light);
    out.fraction[i] = split(grid.shading[i], light).fraction;
    // Direct light shows the true color.
    const double trust = 1 + 9 * out.fraction[i] * out.fraction[i];
    weight[i] = (0.5 + 0.5 * grid.weight[i] / mean_weight) / trust;
    now.add(grid.chroma[i] - out.tint[i], weight[i]);
  }
  out.statistics = tint_statistics(out.tint, out.fraction, weight, params.tint);

  const double all = now.total();
  scene.histogram.resize(now.values().size(), 0.0);
  for (std::size_t b = 0; b < scene.histogram.size(); ++b)
    scene.histogram[b] += renew * (now.values()[b] / all - scene.histogram[b]);
  now.values() = scene.histogram;
  scene.colors = find_modes(now, scene.colors, params.palette);
  for (std::size_t i = 0; i < n; ++i)
    labels[i] = scene.colors.label[now.nearest(grid.chroma[i] - out.tint[i])];
  out.labels = labels;
  out.colors = scene.colors;
  return out;
}

Chroma blend(const std::vector<Chroma>& plane, const Grid& grid, int x, int y) {
  const Between u = between(x, grid.factor, grid.width), v = between(y, grid.factor, grid.height);
  const auto at = [&](std::size_t row, std::size_t column) {
    return plane[row * std::size_t(grid.width) + column];
  };
  return (1 - v.share) * ((1 - u.share) * at(v.low, u.low) + u.share * at(v.low, u.high)) +
         v.share * ((1 - u.share) * at(v.high, u.low) + u.share * at(v.high, u.high));
}

/// Mean change of chroma since the frame before, where there is light, 0 ... 1.
double change_of(const Grid& grid, const std::vector<Chroma>& before) {
  constexpr double kMaxDistance = 0.5;
  double sum = 0, all = 1e-9;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    sum +=
        grid.weight[i] * std::min(std::sqrt(norm2(grid.chroma[i] - before[i])) / kMaxDistance, 1.0);
    all += grid.weight[i];
  }
  return sum / all;
}

/// Estimated brightness of the light before the solve: exp(s) in the scale of the layers.
std::vector<double> guess_shading(const std::vector<double>& rgb, const GlobalParams& params,
                                  const GlobalState* state) {
  const std::size_t n = rgb.size() / 3;
  std::vector<double> shading(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 color = color_at(rgb, i);
    if (!state) {  // the same largest channel for every albedo
      shading[i] = *std::max_element(color.begin(), color.end()) / params.scale.white_level;
      continue;
    }
    double m = 0;  // of the previous reflectance
    for (const double v : color) m += std::log(v + kIntensityFloor) / 3;
    shading[i] = std::exp(m - state->solve.m[i] + state->solve.s[i] - state->log_scale);
  }
  return shading;
}

/// Light and tint of every pixel.
struct Light {
  std::vector<Vec3> indirect;
  std::vector<Chroma> tint;
  std::vector<int> label;
};

Light light_of(const std::vector<double>& rgb, const std::vector<double>& shading, int width,
               int height, const Grid& grid, const Analysis& seen, const GlobalParams& params) {
  const std::size_t n = shading.size();
  const bool gray = seen.colors.used() < 2;
  const auto base = [&](int label) {
    return gray ? Chroma{} : *seen.colors.color[std::size_t(label)];
  };
  std::vector<Chroma> raw(grid.size());
  for (std::size_t i = 0; i < raw.size(); ++i)
    raw[i] = grid.chroma[i] - seen.tint[i] - base(seen.labels[i]);
  const Residual residual =
      residual_field(raw, seen.fraction, grid.width, grid.height, seen.statistics, params.tint);
  const ChromaHistogram bins = empty_histogram(params.palette);
  Light out{std::vector<Vec3>(n), std::vector<Chroma>(n), std::vector<int>(n, 0)};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x);
      const Chroma z = chroma_of(color_at(rgb, i));
      int& label = out.label[i];
      label = seen.colors.label[bins.nearest(z - blend(seen.tint, grid, x, y))];
      Vec3& light = out.indirect[i];
      light = indirect_of(seen.amount, seen.gather.received(label, x, y, 2 * grid.factor));
      if (gray) {
        light = Vec3{mean(light), mean(light), mean(light)};
        continue;
      }
      const Chroma t = tint_of(shading[i], light);
      const double fraction = split(shading[i], light).fraction;
      Chroma e = z - t - base(label);
      const double c = label_confidence(e, fraction, seen.statistics, params.tint);
      e = c * e + (1 - c) * blend(residual.smooth, grid, x, y);
      const Chroma a = blend(residual.slope, grid, x, y), b = blend(residual.offset, grid, x, y);
      const double share = seen.statistics.gate * std::min(1.0, 3 * fraction);
      out.tint[i] = t + share * Chroma{a[0] * e[0] + b[0], a[1] * e[1] + b[1]};
    }
  return out;
}

}  // namespace

GlobalResult decompose_global(const double* input, int width, int height,
                              const GlobalParams& params, GlobalState* state) {
  const std::size_t n = std::size_t(width) * std::size_t(height);
  GlobalState still;
  const bool warm = state && state->solve.width == width && state->solve.height == height &&
                    state->solve.s.size() == n;
  if (state && !warm) *state = {};
  GlobalScene& scene = state ? state->scene : still.scene;
  GlobalResult result;

  std::vector<double> rgb(3 * n);
  for (std::size_t i = 0; i < 3 * n; ++i) rgb[i] = sanitize_linear(input[i]);
  const int factor = grid_factor(width, height, params.grid);
  // A cut is decided from the unprocessed frame.
  const Grid raw = make_grid(rgb, std::vector<double>(n, 1.0), width, height, factor);
  if (warm && change_of(raw, scene.chroma) > params.cut_chroma) {
    result.cut = true;
    scene = {};
  }
  scene.chroma = raw.chroma;
  const double renew = std::max(params.update_rate, 1.0 / (scene.frames + 1));
  if (params.white_balance > 0) {
    scene.white = scene.white + renew * (params.white_balance * illuminant(raw) - scene.white);
    const Vec3 color = color_of(scene.white);
    for (std::size_t i = 0; i < 3 * n; ++i) rgb[i] /= color[i % 3];
  }
  result.white = scene.white;
  // As it were in white light, for all but the solve.
  const std::vector<double> lamps = rgb;
  const LightColor& color_of_light = params.solve.light;
  for (std::size_t i = 0; i < n; ++i) {
    const auto white = in_white_light({rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]}, color_of_light);
    std::copy(white.begin(), white.end(), rgb.begin() + std::ptrdiff_t(3 * i));
  }
  const std::vector<double> shading =
      guess_shading(rgb, params, warm && !result.cut ? state : nullptr);
  const Grid grid = make_grid(rgb, shading, width, height, factor);
  const double spread = color_spread(grid), usable = usable_color(spread, params.amount);
  if (usable <= 0) scene = {.chroma = raw.chroma, .white = scene.white};
  Analysis seen;
  Light light{std::vector<Vec3>(n), std::vector<Chroma>(n), std::vector<int>(n, 0)};
  if (usable > 0) {
    seen = analyze(grid, params, renew, spread, scene);
    ++scene.frames;
    light = light_of(rgb, shading, width, height, grid, seen, params);
  }

  std::vector<double> plain(3 * n);
  std::vector<Vec3> tau(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 color = color_of(light.tint[i]);
    for (std::size_t c = 0; c < 3; ++c) {
      const double in = lamps[3 * i + c];
      tau[i][c] = std::max({color[c], kMinTau, in / kMaxLight});
      plain[3 * i + c] = in / tau[i][c];
    }
  }
  IntrinsicParams solve = params.solve;
  if (warm) solve.cycles = params.warm_cycles;
  const IntrinsicResult bright =
      decompose(plain.data(), width, height, solve, state ? &state->solve : nullptr);
  result.stats = bright.stats;
  OutputScale& scale = state ? state->scale : still.scale;
  const double log_scale = scale.update(make_guide(plain.data(), width, height, color_of_light),
                                        bright.log_shading, bright.stats.anchored);
  if (state) state->log_scale = log_scale;

  result.reflectance.resize(3 * n), result.indirect.resize(3 * n), result.direct.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const PixelLight layers =
        compose(std::exp(bright.log_shading[i] - log_scale), tau[i], light.indirect[i]);
    result.direct[i] = layers.direct;
    const auto color = light_color(color_of_light, bright.log_shading[i] - color_of_light.white);
    for (std::size_t c = 0; c < 3; ++c) {
      result.indirect[3 * i + c] = layers.indirect[c];
      result.reflectance[3 * i + c] =
          lamps[3 * i + c] / std::max(layers.direct + layers.indirect[c], 1e-9) / color[c];
    }
  }
  result.label = light.label;
  result.colors = seen.colors;
  // Layers use the frame's own base colors, which are newer than those of the gather.
  if (usable > 0) result.gather = Gather(grid, seen.labels, params.palette.most, params.gather);
  result.gather_factor = 2 * factor;
  result.amount = seen.amount;
  result.tint = seen.statistics.full;
  return result;
}

}  // namespace inverse::reference
