// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stylize.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace inverse::reference {
namespace {

constexpr double kDark = 0.05;
constexpr double kRatio = 1.6;
constexpr double kReflectanceFloor = 1e-3;
constexpr double kLargest = 65504;

/// The largest answer of G(sigma) − G(kRatio sigma) to a step from 0 to 1.
double step_response() {
  const double t = std::sqrt(2 * std::log(kRatio) / (1 - 1 / (kRatio * kRatio)));
  const auto normal = [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); };
  return normal(t) - normal(t / kRatio);
}

/// One direction of a Gaussian of radius `radius`.
Field along(const Field& field, double sigma, int radius, bool down) {
  std::vector<double> weights;
  double sum = 0;
  for (int k = -radius; k <= radius; ++k) {
    weights.push_back(std::exp(-k * k / (2 * sigma * sigma)));
    sum += weights.back();
  }
  Field result = field;
  for (unsigned y = 0; y < field.height; ++y)
    for (unsigned x = 0; x < field.width; ++x) {
      double value = 0;
      for (int k = -radius; k <= radius; ++k)
        value += weights[static_cast<size_t>(k + radius)] *
                 field.at_or_border(long{x} + (down ? 0 : k), long{y} + (down ? k : 0));
      result.at(x, y) = value / sum;
    }
  return result;
}

std::array<double, 3> log_reflectance(const Rgba& p) {
  std::array<double, 3> result{};
  for (size_t c = 0; c < 3; ++c) result[c] = std::log(std::max(p[c], kReflectanceFloor));
  return result;
}

LayersField flattened_along(const LayersField& layers, double sigma, double difference, bool down) {
  LayersField result = layers;
  const long radius = static_cast<long>(std::ceil(2 * sigma));
  for (long y = 0; y < layers.height; ++y)
    for (long x = 0; x < layers.width; ++x) {
      const auto pixel = [&](long column, long row) {
        return finite(layers.pixels[static_cast<size_t>(row * layers.width + column)]);
      };
      const Rgba own = pixel(x, y);
      const auto center = log_reflectance(own);
      Rgb sum{};
      double weights = 0;
      for (long k = -radius; k <= radius; ++k) {
        const long column = x + (down ? 0 : k), row = y + (down ? k : 0);
        if (column < 0 || row < 0 || column >= layers.width || row >= layers.height) continue;
        const Rgba other = pixel(column, row);
        const auto its_log = log_reflectance(other);
        double apart = 0;
        for (size_t c = 0; c < 3; ++c) apart += std::pow(its_log[c] - center[c], 2);
        const double weight = std::exp(-static_cast<double>(k * k) / (2 * sigma * sigma) -
                                       std::min(apart / (2 * difference * difference), 80.0));
        for (size_t c = 0; c < 3; ++c) sum[c] += weight * other[c];
        weights += weight;
      }
      result.pixels[static_cast<size_t>(y * layers.width + x)] = {
          sum[0] / weights, sum[1] / weights, sum[2] / weights, own[3]};
    }
  return result;
}

}  // namespace

double Field::at_or_border(long x, long y) const {
  x = std::clamp(x, 0L, long{width} - 1);
  y = std::clamp(y, 0L, long{height} - 1);
  return values[static_cast<size_t>(y) * width + static_cast<size_t>(x)];
}

double encoded_shading(double s) { return std::log2(1 + s / kDark); }
double decoded_shading(double e) { return kDark * (std::exp2(e) - 1); }

Field encoded_shading(const LayersField& layers) {
  Field field{layers.width, layers.height, {}};
  for (const Rgba& p : layers.pixels) field.values.push_back(encoded_shading(finite(p[3])));
  return field;
}

Field gaussian(const Field& field, double sigma) {
  const int radius = static_cast<int>(std::ceil(5 * sigma));
  return along(along(field, sigma, radius, false), sigma, radius, true);
}

Field blurred(const Field& field, double sigma, double ratio) {
  unsigned factor = 1;
  while (sigma / (2 * factor) >= 1.5) factor *= 2;
  const double f = factor;
  // Variances add: the cells', the interpolation's, and the rest.
  const double other = factor > 1 ? (f * f - 1) / 12 + f * f / 6 : 0;
  const auto in_cells = [&](double s) { return std::sqrt(s * s - other) / f; };
  const int radius = static_cast<int>(std::ceil(3 * in_cells(kRatio * sigma)));
  Field cells{(field.width - 1) / factor + 1, (field.height - 1) / factor + 1, {}};
  cells.values.resize(size_t{cells.width} * cells.height);
  for (unsigned y = 0; y < cells.height; ++y)
    for (unsigned x = 0; x < cells.width; ++x) {
      for (unsigned n = 0; n < factor * factor; ++n)
        cells.at(x, y) += field.at_or_border(x * factor + n % factor, y * factor + n / factor);
      cells.at(x, y) /= f * f;
    }
  const double sigma_in_cells = in_cells(ratio * sigma);
  cells = along(along(cells, sigma_in_cells, radius, false), sigma_in_cells, radius, true);
  Field result = field;
  for (unsigned y = 0; y < field.height; ++y)
    for (unsigned x = 0; x < field.width; ++x) {
      const double u = (x + 0.5) / f - 0.5, v = (y + 0.5) / f - 0.5;
      const long i = std::lround(std::floor(u)), j = std::lround(std::floor(v));
      const double s = u - static_cast<double>(i), t = v - static_cast<double>(j);
      result.at(x, y) =
          (1 - t) * ((1 - s) * cells.at_or_border(i, j) + s * cells.at_or_border(i + 1, j)) +
          t * ((1 - s) * cells.at_or_border(i, j + 1) + s * cells.at_or_border(i + 1, j + 1));
    }
  return result;
}

double drawn_shading(double s, double near, double wide, const StylizeSpec& spec) {
  double drawn = finite(s);
  if (spec.levels > 0) {
    const double step = encoded_shading(1) / spec.levels;
    const double off = encoded_shading(finite(s)) - near;
    const double edge = std::clamp((std::abs(off) - 0.25) / 0.5, 0.0, 1.0);
    const double place = (near + edge * edge * (3 - 2 * edge) * off) / step,
                 lower = std::floor(place);
    const double t =
        std::clamp((place - lower - 0.5) / std::max(spec.softness, 1e-3) + 0.5, 0.0, 1.0);
    drawn = decoded_shading((lower + t * t * (3 - 2 * t)) * step);
  }
  const double height = (wide - near) / step_response();
  return drawn * (1 - std::tanh(spec.sharpness * std::max(spec.sensitivity * height - 1, 0.0)));
}

LayersField flattened(const LayersField& layers, double sigma, double difference) {
  return flattened_along(flattened_along(layers, sigma, difference, false), sigma, difference,
                         true);
}

LayersField stylize(const LayersField& layers, const std::vector<double>& matte,
                    const StylizeSpec& spec) {
  const Field shading = encoded_shading(layers);
  const Field near = blurred(shading, spec.scale, 1), wide = blurred(shading, spec.scale, kRatio);
  const LayersField flat =
      spec.flatten > 0 ? flattened(layers, std::min(2 * spec.scale, 6.0), spec.flatten) : layers;
  LayersField result = layers;
  for (size_t n = 0; n < layers.pixels.size(); ++n) {
    const Rgba own = finite(layers.pixels[n]);
    Rgba drawn = finite(flat.pixels[n]);
    drawn[3] = drawn_shading(own[3], near.values[n], wide.values[n], spec);
    const double share = spec.strength * (matte.empty() ? 1 : std::min(finite(matte[n]), 1.0));
    for (size_t c = 0; c < 4; ++c)
      result.pixels[n][c] = std::min(own[c] + share * (drawn[c] - own[c]), kLargest);
  }
  return result;
}

}  // namespace inverse::reference
