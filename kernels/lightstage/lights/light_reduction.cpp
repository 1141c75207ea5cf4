// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_reduction.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace inverse {
namespace {

constexpr int kSweeps = 25;       // of the fit
constexpr size_t kCheap = 64;     // up to this number, fitting is cheap
constexpr double kMargin = 0.85;  // the first number of lights below an error may be so by chance

float dot(const float* a, const float* b, size_t count) {
  // Eight partial sums, which compilers vectorize.
  std::array<float, 8> sums{};
  size_t i = 0;
  for (; i + 8 <= count; i += 8)
    for (size_t k = 0; k < 8; ++k) sums[k] += a[i + k] * b[i + k];
  float sum = 0;
  for (const float s : sums) sum += s;
  for (; i < count; ++i) sum += a[i] * b[i];
  return sum;
}

/// Least squares on the normal equations by coordinate descent; each weight keeps its sign.
void fit(const std::vector<std::vector<float>>& gram, const std::vector<float>& right,
         const std::vector<float>& signs, std::vector<float>& x) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    float max = 0, moved = 0;
    for (size_t i = 0; i < x.size(); ++i) {
      if (gram[i][i] <= 0) continue;
      float rest = right[i];
      for (size_t k = 0; k < x.size(); ++k) rest -= gram[std::max(i, k)][std::min(i, k)] * x[k];
      const float to = signs[i] * std::max(0.0F, signs[i] * (x[i] + rest / gram[i][i]));
      moved = std::max(moved, std::fabs(to - x[i]));
      max = std::max(max, std::fabs(to));
      x[i] = to;
    }
    if (moved <= 1e-4F * max) return;
  }
}

}  // namespace

void LightReduction::set_responses(std::span<const float> responses) {
  const size_t lights = lights_.size(), given = responses.size() / (4 * lights);
  std::vector<std::pair<size_t, double>> bright;  // samples and how bright they are
  double max = 0;
  for (size_t s = 0; s < given; ++s) {
    double sum = 0;
    for (size_t i = 0; i < lights; ++i)
      for (size_t c = 0; c < 3; ++c) sum += responses[4 * (s * lights + i) + c];
    if (!(sum >= 0 && sum < 1e30)) continue;
    bright.emplace_back(s, sum);
    max = std::max(max, sum);
  }
  std::erase_if(bright, [max](const auto& one) { return one.second <= 1e-4 * max; });
  tested_ = bright.size() / 2;
  fitted_ = bright.size() - tested_;
  responses_.resize(3 * lights * bright.size());
  for (size_t n = 0; n < bright.size(); ++n) {
    const size_t to = n % 2 == 0 ? n / 2 : fitted_ + n / 2;
    for (size_t i = 0; i < lights; ++i)
      for (size_t c = 0; c < 3; ++c)
        responses_[(3 * i + c) * bright.size() + to] =
            responses[4 * (bright[n].first * lights + i) + c];
  }
}

std::vector<float> LightReduction::sum(std::span<const Rgb> weights) const {
  std::vector<float> result(3 * samples());
  for (size_t i = 0; i < lights_.size(); ++i)
    for (size_t c = 0; c < 3; ++c) {
      if (weights[i][c] == 0) continue;
      const float* from = response(i, c);
      float* to = &result[c * samples()];
      for (size_t s = 0; s < samples(); ++s) to[s] += weights[i][c] * from[s];
    }
  return result;
}

LightReduction::Choice LightReduction::all(std::span<const Rgb> weights) const {
  Choice choice;
  choice.all = true;
  for (size_t i = 0; i < lights_.size(); ++i) {
    if (weights[i] == Rgb{}) continue;
    choice.lights.push_back({lights_[i], weights[i]});
    choice.indices.push_back(static_cast<uint32_t>(i));
  }
  return choice;
}

double LightReduction::error(const Choice& choice, std::span<const Rgb> weights,
                             std::span<const Rgb> whole) const {
  if (samples() == 0) return 0;
  std::vector<Rgb> chosen(lights_.size());
  for (size_t k = 0; k < choice.lights.size(); ++k)
    chosen[choice.indices[k]] = choice.lights[k].weight;
  const auto target = sum(weights), part = sum(chosen), picture = sum(whole);
  double difference = 0, total = 0;
  for (size_t i = 0; i < target.size(); ++i) {
    difference += std::fabs(target[i] - part[i]);
    total += picture[i];
  }
  return total > 0 ? difference / total : 0;
}

LightReduction::Choice LightReduction::choose(std::span<const Rgb> weights,
                                              std::span<const Rgb> whole, double max_error) const {
  const Choice everything = all(weights);
  if (!ready() || max_error <= 0) return everything;
  const size_t count = lights_.size(), lit = everything.lights.size();
  const size_t max_count = std::min(2 * lit / 3, std::max(kCheap, lit / 3));
  const std::vector<float> target = sum(weights), picture = sum(whole);
  double total = 0, off = 0;  // of the samples that are tested on
  for (size_t c = 0; c < 3; ++c)
    for (size_t s = fitted_; s < samples(); ++s) {
      total += picture[c * samples() + s];
      off += std::fabs(target[c * samples() + s]);
    }
  Choice choice;
  if (total <= 0) return choice;
  choice.error = off / total;
  if (choice.error <= kMargin * max_error) return choice;
  std::vector<float> rest = target;
  std::vector<char> taken(count);
  std::vector<std::array<float, 3>> sizes(count);
  for (const uint32_t i : everything.indices)
    for (size_t c = 0; c < 3; ++c) sizes[i][c] = dot(response(i, c), response(i, c), fitted_);
  // Per channel: inner products of the selected lights with each other and with the target.
  std::array<std::vector<std::vector<float>>, 3> gram;
  std::array<std::vector<float>, 3> right, signs, x;
  while (choice.lights.size() < max_count) {
    size_t best = count;
    double explains = 0;
    for (const uint32_t i : everything.indices) {
      if (taken[i]) continue;
      double gain = 0;
      for (size_t c = 0; c < 3; ++c) {
        const float along = dot(response(i, c), &rest[c * samples()], fitted_);
        if (sizes[i][c] > 0) gain += double{along} * along / sizes[i][c];
      }
      if (gain > explains) {
        explains = gain;
        best = i;
      }
    }
    if (best == count) break;
    taken[best] = 1;
    choice.indices.push_back(static_cast<uint32_t>(best));
    choice.lights.push_back({lights_[best], {}});
    for (size_t c = 0; c < 3; ++c)
      signs[c].push_back(dot(response(best, c), &rest[c * samples()], fitted_) < 0 ? -1.0F : 1.0F);
    rest = target;
    for (size_t c = 0; c < 3; ++c) {
      std::vector<float> row;
      for (const uint32_t k : choice.indices)
        row.push_back(dot(response(best, c), response(k, c), fitted_));
      gram[c].push_back(std::move(row));
      right[c].push_back(dot(response(best, c), &target[c * samples()], fitted_));
      x[c].push_back(0);
      fit(gram[c], right[c], signs[c], x[c]);
      for (size_t k = 0; k < x[c].size(); ++k) {
        choice.lights[k].weight[c] = x[c][k];
        const float* from = response(choice.indices[k], c);
        float* to = &rest[c * samples()];
        for (size_t s = 0; s < samples(); ++s) to[s] -= x[c][k] * from[s];
      }
    }
    off = 0;
    for (size_t c = 0; c < 3; ++c)
      for (size_t s = fitted_; s < samples(); ++s) off += std::fabs(rest[c * samples() + s]);
    choice.error = off / total;
    if (choice.error <= kMargin * max_error) return choice;
  }
  return everything;
}

}  // namespace inverse
