// SPDX-License-Identifier: LGPL-2.1-or-later
#include "relight_subject.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "kernels/environment/environment.hpp"

namespace inverse::bench {
namespace {

/// Weights of one row's or column's pixels for one of the resized.
struct Taps {
  int first;
  std::vector<float> weights;
};

std::vector<Taps> taps(int from, int to) {
  std::vector<Taps> all;
  const double step = static_cast<double>(from) / to, reach = std::max(step, 1.0);
  for (int i = 0; i < to; ++i) {
    const double middle = (i + .5) * step - .5;
    const int first = static_cast<int>(std::ceil(middle - reach));
    Taps one{std::clamp(first, 0, from - 1), {}};
    double sum = 0;
    for (int k = one.first; k <= std::min(from - 1, static_cast<int>(middle + reach)); ++k) {
      one.weights.push_back(static_cast<float>(std::max(0.0, 1 - std::fabs(k - middle) / reach)));
      sum += one.weights.back();
    }
    for (float& w : one.weights) w /= static_cast<float>(sum);
    all.push_back(one);
  }
  return all;
}

}  // namespace

std::vector<OlatSet> read_sets(const std::vector<std::string>& paths) {
  std::vector<OlatSet> sets;
  for (const std::string& path : paths) sets.push_back(read_olat_set(path));
  if (sets.empty())
    std::printf("no sets were named: nothing is measured (import-olat makes them)\n");
  return sets;
}

std::vector<NamedEnvironment> read_environments(const std::vector<std::string>& paths) {
  std::vector<NamedEnvironment> environments;
  for (const std::string& path : paths)
    environments.push_back(
        {std::filesystem::path(path).stem().string(), LightCells::map(Environment::load(path))});
  if (environments.empty())
    environments.push_back({"studio", LightCells::map(Environment::studio())});
  return environments;
}

std::vector<WeightedLight> weighted(const RelightStage& stage, std::span<const Rgb> weights) {
  std::vector<WeightedLight> lights;
  for (size_t i = 0; i < weights.size(); ++i) lights.push_back({stage.lights()[i], weights[i]});
  return lights;
}

Image true_sum(const OlatSet& set, std::span<const Rgb> weights) {
  Image sum(set.a.width, set.a.height, 3);
  for (size_t i = 0; i < weights.size(); ++i)
    for (size_t n = 0; n < sum.data.size(); ++n)
      sum.data[n] += weights[i][n % 3] * set.lights[i].data[n];
  return sum;
}

double relative(const Image& got, const Image& truth, const Image& mask) {
  double off = 0, total = 0;
  for (size_t n = 0; n < truth.data.size(); ++n) {
    if (mask.data[n / 3] < .5F) continue;
    off += std::fabs(double{got.data[n]} - truth.data[n]);
    total += truth.data[n];
  }
  return off / total;
}

Image resized(const Image& image, int width, int height) {
  Image wide(width, image.height, image.channels), all(width, height, image.channels);
  const auto across = taps(image.width, width), down = taps(image.height, height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < image.channels; ++c)
        for (size_t k = 0; k < across[size_t(x)].weights.size(); ++k)
          wide.at(x, y, c) += across[size_t(x)].weights[k] *
                              image.at(across[size_t(x)].first + static_cast<int>(k), y, c);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < image.channels; ++c)
        for (size_t k = 0; k < down[size_t(y)].weights.size(); ++k)
          all.at(x, y, c) += down[size_t(y)].weights[k] *
                             wide.at(x, down[size_t(y)].first + static_cast<int>(k), c);
  return all;
}

}  // namespace inverse::bench
