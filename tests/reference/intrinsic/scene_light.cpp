// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene_light.hpp"

#include <algorithm>
#include <cmath>

#include "intrinsic_features.hpp"

namespace inverse::reference {
namespace {

constexpr int kSamples = 4;  // along a point's pixels
constexpr int kWidth = 16, kTaps = 7, kDense = 12, kHidden = kWidth * SceneLight::kSlopes;

double leaky(double v) { return v > 0 ? v : 0.1 * v; }

PointLevel halved(const PointLevel& fine) {
  PointLevel coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
  for (int y = 0; y < coarse.height; ++y)
    for (int x = 0; x < coarse.width; ++x) {
      std::array<double, 4> mean{};
      int count = 0;
      for (int v = 2 * y; v < std::min(2 * y + 2, fine.height); ++v)
        for (int u = 2 * x; u < std::min(2 * x + 2, fine.width); ++u, ++count)
          for (std::size_t k = 0; k < 4; ++k) mean[k] += fine.at(u, v)[k];
      for (double& v : mean) v /= count;
      coarse.points.push_back(mean);
    }
  return coarse;
}

/// The quantile .95 of m, in bins of 1/32.
double bright_of(const PointLevel& level) {
  constexpr int kBins = 256;
  std::array<unsigned, kBins> counts{};
  for (const auto& point : level.points)
    ++counts[std::size_t(std::clamp((point[0] + 6.4) * kBins / 8, 0.0, kBins - 1.0))];
  const auto above = unsigned((1 - 0.95F) * float(level.points.size()));
  std::size_t bin = kBins - 1;
  for (unsigned over = counts[bin]; over <= above && bin > 0; over += counts[bin]) --bin;
  return -6.4 + (double(bin) + 0.5) / 32;
}

/// A convolution along the slopes, 0 beyond their ends.
std::vector<double> convolved(const std::vector<double>& in, int channels, const double* weights,
                              const double* bias) {
  std::vector<double> out;
  for (int o = 0; o < kWidth; ++o)
    for (int x = 0; x < SceneLight::kSlopes; ++x) {
      double sum = bias[o];
      for (int k = 0; k < channels; ++k)
        for (int t = 0; t < kTaps; ++t) {
          const int at = x + t - kTaps / 2;
          if (at >= 0 && at < SceneLight::kSlopes)
            sum += weights[(o * channels + k) * kTaps + t] *
                   in[std::size_t(k * SceneLight::kSlopes + at)];
        }
      out.push_back(leaky(sum));
    }
  return out;
}

}  // namespace

PointLevel SceneLight::points_of(const double* rgb, int width, int height, int factor) {
  PointLevel level{(width + factor - 1) / factor, (height + factor - 1) / factor, {}};
  for (int y = 0; y < level.height; ++y)
    for (int x = 0; x < level.width; ++x) {
      const int columns = std::min(width - factor * x, factor);
      const int rows = std::min(height - factor * y, factor);
      const int across = std::min(columns, kSamples), down = std::min(rows, kSamples);
      std::array<double, 3> mean{};
      for (int v = 0; v < down; ++v)
        for (int u = 0; u < across; ++u) {
          const int px = factor * x + (2 * u + 1) * columns / (2 * across);
          const int py = factor * y + (2 * v + 1) * rows / (2 * down);
          for (std::size_t c = 0; c < 3; ++c) {
            const double light =
                rgb[3 * (std::size_t(py) * std::size_t(width) + std::size_t(px)) + c];
            mean[c] += std::min(sanitize_linear(light), 1.0) / (across * down);
          }
        }
      std::array<double, 3> color{};
      double m = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        color[c] = std::log(mean[c] + 0.01);
        m += std::log(mean[c] + kIntensityFloor) / 3;
      }
      const double light = std::exp(m);
      level.points.push_back(
          {m, color[0] - color[2], 0.5 * (color[0] + color[2]) - color[1], light / (light + 0.02)});
    }
  return level;
}

std::vector<double> SceneLight::features_of(PointLevel level) {
  std::vector<double> counts(std::size_t(kChannels) * kSlopes);
  for (std::size_t l = 0; l < kLevels; ++l, level = halved(level)) {
    const auto count = [&](std::array<double, 4> one, std::array<double, 4> other) {
      if (one[0] < other[0]) std::swap(one, other);
      const double m = one[0] - other[0], b = one[1] - other[1], g = std::abs(one[2] - other[2]);
      const int size = int(std::clamp(std::floor(1.6 * std::log2(std::max(m, 1e-3) / 0.03)), -1.0,
                                      kSizes - 2.0)) +
                       1;
      const int tint = int(g > 0.02 + 0.08 * m) + int(g > 0.06 + 0.3 * m);
      const double place =
          std::clamp(b / std::max(m, 0.01) / 0.1 + kSlopes / 2, 0.0, kSlopes - 1.001);
      const double weight = 1 / (1 + std::exp(-3 * (other[0] + 4)));
      const double share = place - std::floor(place);
      const std::size_t at =
          ((l * kTints + std::size_t(tint)) * kSizes + std::size_t(size)) * kSlopes +
          std::size_t(place);
      const double unit = 1000.0 / (2.0 * double(level.points.size()));
      counts[at] += unit * weight * (1 - share);
      counts[at + 1] += unit * weight * share;
    };
    for (int y = 0; y < level.height; ++y)
      for (int x = 0; x < level.width; ++x) {
        if (x + 1 < level.width) count(level.at(x, y), level.at(x + 1, y));
        if (y + 1 < level.height) count(level.at(x, y), level.at(x, y + 1));
      }
  }
  for (double& c : counts) c = std::log1p(2 * c);
  return counts;
}

std::vector<double> SceneLight::cloud_of(const PointLevel& points, double bright) {
  std::vector<double> cloud(std::size_t(kCloudRows) * kCloudColumns);
  for (const auto& point : points.points) {
    const int row = int(std::clamp((bright - point[0]) / 0.4, 0.0, kCloudRows - 1.0));
    const double place = std::clamp(point[1] / 0.1 + kCloudColumns / 2, 0.0, kCloudColumns - 1.001);
    const double share = place - std::floor(place), unit = 1.0 / double(points.points.size());
    const std::size_t at = std::size_t(row * kCloudColumns) + std::size_t(place);
    cloud[at] += unit * (1 - share);
    cloud[at + 1] += unit * share;
  }
  return cloud;
}

std::array<double, SceneLight::kCandidates> SceneLight::votes_of(
    const std::vector<double>& features, const std::vector<double>& cloud) const {
  const double* next = weights_.data();
  const auto take = [&](int count) {
    const double* first = next;
    next += count;
    return first;
  };
  const double *a = take(kWidth * kChannels * kTaps), *a_bias = take(kWidth),
               *b = take(kWidth * kWidth * kTaps), *b_bias = take(kWidth), *c = take(kWidth),
               *c_bias = take(1), *d = take(kDense * kHidden), *d_bias = take(kDense),
               *of_cloud = take(kDense * int(cloud.size())), *cloud_bias = take(kDense),
               *e = take(kCandidates * kDense), *e_bias = take(kCandidates);
  const std::vector<double> hidden = convolved(features, kChannels, a, a_bias);
  const std::vector<double> second = convolved(hidden, kWidth, b, b_bias);
  std::array<double, kDense> dense{};
  for (std::size_t i = 0; i < kDense; ++i) {
    dense[i] = d_bias[i] + cloud_bias[i];
    for (std::size_t k = 0; k < hidden.size(); ++k)
      dense[i] += d[i * hidden.size() + k] * hidden[k];
    for (std::size_t k = 0; k < cloud.size(); ++k)
      dense[i] += of_cloud[i * cloud.size() + k] * std::log1p(300 * cloud[k]);
    dense[i] = leaky(dense[i]);
  }
  std::array<double, kCandidates> votes{};
  for (std::size_t i = 0; i < kCandidates; ++i) {
    votes[i] = c_bias[0] + e_bias[i];
    for (std::size_t k = 0; k < kWidth; ++k)
      votes[i] += c[k] * second[k * kSlopes + i + (kSlopes - kCandidates) / 2];
    for (std::size_t k = 0; k < kDense; ++k) votes[i] += e[i * kDense + k] * dense[k];
  }
  return votes;
}

const SceneLight::State& SceneLight::update(const double* rgb, int width, int height, bool first,
                                            bool due, std::optional<double> given) {
  const int factor = (std::max(width, height) + kPoints - 1) / kPoints;
  const PointLevel probe = points_of(rgb, width, height, 4 * factor);
  const double bright = bright_of(probe);
  const std::vector<double> cloud = cloud_of(probe, bright);
  double change = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    change += std::abs(cloud[i] - (cloud_.empty() ? 0 : cloud_[i])) / 2;
  cloud_ = cloud;
  const bool cut = first || !known_ || !(change < 0.5);
  known_ = true;
  const double lag = cut ? 0 : std::clamp(exposure_, -0.02, 0.02);
  state_.reference = cut ? bright : state_.reference + exposure_ - lag;
  exposure_ = lag;
  std::array<double, 3> mean{}, square{}, variance{};
  double all = 0;
  for (const auto& point : probe.points) {
    all += point[3];
    for (std::size_t k = 0; k < 3; ++k) {
      mean[k] += point[3] * point[k];
      square[k] += point[3] * point[k] * point[k];
    }
  }
  for (std::size_t k = 0; k < 3; ++k)
    variance[k] =
        std::max(square[k] / std::max(all, 1e-6) - std::pow(mean[k] / std::max(all, 1e-6), 2), 0.0);
  const double spread = std::clamp((std::sqrt(variance[1] + variance[2]) - 0.02) / 0.03, 0.0, 1.0);
  const double usable = spread * spread * (3 - 2 * spread);
  if (given) {
    const double confidence = *given != 0 ? 1 : 0;
    state_ = {*given, state_.reference, confidence, *given, 0, 0, Did::reused};
    return state_;
  }
  if (cut) state_ = {.reference = state_.reference};
  const bool none = state_.measurements == 0;  // in this scene
  state_.did = usable == 0                 ? Did::no_color
               : variance[0] < 0.05 * 0.05 ? Did::no_contrast
               : none || due               ? Did::measured
                                           : Did::reused;
  if (state_.did == Did::measured) measure(points_of(rgb, width, height, factor), cloud);
  if (state_.measurements > 0)
    state_.confidence = std::clamp((0.6 - state_.spread) / 0.2, 0.0, 1.0);
  const double goal = usable * state_.confidence * state_.target, off = goal - state_.slope;
  if (cut || (none && state_.did == Did::measured))
    state_.slope = goal;
  else if (usable == 0 || (state_.confidence > 0 && std::abs(off) > std::max(0.05, state_.spread)))
    state_.slope += std::clamp(0.05 * off, -0.004, 0.004);
  return state_;
}

void SceneLight::measure(const PointLevel& points, const std::vector<double>& cloud) {
  const auto votes = votes_of(features_of(points), cloud);
  const double share = std::max(1.0 / 16, 1.0 / (state_.measurements + 1));
  double top = -1e30;
  for (std::size_t i = 0; i < votes.size(); ++i) {
    votes_[i] = state_.measurements == 0 ? votes[i] : votes_[i] + share * (votes[i] - votes_[i]);
    top = std::max(top, votes_[i]);
  }
  double sum = 0, first_moment = 0, second_moment = 0;
  for (int i = 0; i < kCandidates; ++i) {
    const double p = std::exp(votes_[std::size_t(i)] - top), k = candidate(i);
    sum += p, first_moment += p * k, second_moment += p * k * k;
  }
  state_.target = first_moment / sum;
  state_.spread = std::sqrt(std::max(second_moment / sum - state_.target * state_.target, 0.0));
  ++state_.measurements;
}

}  // namespace inverse::reference
