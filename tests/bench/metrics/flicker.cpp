// SPDX-License-Identifier: LGPL-2.1-or-later
#include <algorithm>
#include <cmath>

#include "detail.hpp"
#include "metrics.hpp"

namespace inverse::bench {
namespace {

/// Logarithm of the mean channel at the counting pixels, minus its mean when `centered`.
std::vector<double> log_values(const Image& image, const Image& mask, bool centered) {
  detail::check_sizes(image, image, mask);
  std::vector<double> values;
  double sum = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (detail::counts(mask, x, y)) {
        values.push_back(detail::log_mean_channel(image, x, y));
        sum += values.back();
      }
  if (centered)
    for (double& v : values) v -= sum / double(values.size());
  return values;
}

double deviation(double sum, double squares, double count) {
  return std::sqrt(std::max(0.0, squares / count - sum * sum / (count * count)));
}

constexpr std::size_t kMinPoints = 15;

bool seen(const Track& track, std::size_t frame) {
  return frame < track.size() && !std::isnan(track[frame][0] + track[frame][1]);
}

/// Every channel, bilinear, clamped to the image.
std::vector<double> channels_at(const Image& image, double x, double y) {
  const double u = std::clamp(x, 0.0, image.width - 1.0),
               v = std::clamp(y, 0.0, image.height - 1.0);
  const int x0 = int(u), y0 = int(v), x1 = std::min(x0 + 1, image.width - 1),
            y1 = std::min(y0 + 1, image.height - 1);
  const double fx = u - x0, fy = v - y0;
  std::vector<double> values;
  for (int c = 0; c < image.channels; ++c)
    values.push_back((1 - fy) * ((1 - fx) * image.at(x0, y0, c) + fx * image.at(x1, y0, c)) +
                     fy * ((1 - fx) * image.at(x0, y1, c) + fx * image.at(x1, y1, c)));
  return values;
}

/// Logarithm of the mean channel.
double sample(const Image& image, double x, double y) {
  double mean = 0;
  for (const double value : channels_at(image, x, y)) mean += value / image.channels;
  return std::log(std::max(mean, detail::kLogFloor));
}

}  // namespace

double flicker(const std::vector<Image>& reflectance, bool remove_scale, const Image& mask) {
  if (reflectance.size() < 2) return 0.0;
  std::vector<double> sum, squares;
  for (const Image& r : reflectance) {
    const std::vector<double> l = log_values(r, mask, remove_scale);
    sum.resize(l.size()), squares.resize(l.size());
    for (std::size_t i = 0; i < l.size(); ++i) sum[i] += l[i], squares[i] += l[i] * l[i];
  }
  double total = 0;
  for (std::size_t i = 0; i < sum.size(); ++i)
    total += deviation(sum[i], squares[i], double(reflectance.size()));
  return sum.empty() ? 0.0 : total / double(sum.size());
}

double flicker_along(const std::vector<Image>& reflectance, const std::vector<Track>& tracks,
                     bool remove_scale) {
  const std::size_t frames = reflectance.size();
  const double nowhere = std::nan("");
  std::vector<std::vector<double>> deviations;  // of every track from its own mean, by frame
  for (const Track& track : tracks) {
    std::vector<double> values(frames, nowhere);
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < std::min(frames, track.size()); ++k)
      if (!std::isnan(track[k][0]) && !std::isnan(track[k][1])) {
        values[k] = sample(reflectance[k], track[k][0], track[k][1]);
        sum += values[k], count += 1;
      }
    if (count < 2) continue;
    for (double& v : values) v -= sum / count;
    deviations.push_back(values);
  }
  if (remove_scale)
    for (std::size_t k = 0; k < frames; ++k) {
      double sum = 0, count = 0;
      for (const auto& d : deviations)
        if (!std::isnan(d[k])) sum += d[k], count += 1;
      for (auto& d : deviations) d[k] -= count > 0 ? sum / count : 0;
    }
  double total = 0;
  for (const auto& d : deviations) {
    double sum = 0, squares = 0, count = 0;
    for (double v : d)
      if (!std::isnan(v)) sum += v, squares += v * v, count += 1;
    total += deviation(sum, squares, count);
  }
  return deviations.empty() ? 0.0 : total / double(deviations.size());
}

double common_drift(const std::vector<Image>& reflectance, const std::vector<Track>& tracks,
                    std::size_t span) {
  double total = 0, count = 0;
  for (std::size_t k = 0; k + span < reflectance.size(); ++k) {
    std::vector<double> changes;
    for (const Track& track : tracks) {
      if (track.size() <= k + span) continue;
      const auto &from = track[k], &to = track[k + span];
      if (std::isnan(from[0] + from[1] + to[0] + to[1])) continue;
      changes.push_back(sample(reflectance[k + span], to[0], to[1]) -
                        sample(reflectance[k], from[0], from[1]));
    }
    if (changes.size() < kMinPoints) continue;
    const auto middle = changes.begin() + std::ptrdiff_t(changes.size() / 2);
    std::nth_element(changes.begin(), middle, changes.end());
    total += std::abs(*middle);
    count += 1;
  }
  return count > 0 ? total / count : 0.0;
}

PatchVariation patch_variation(const std::vector<Image>& reflectance,
                               const std::vector<Track>& patch) {
  if (reflectance.empty()) return {};
  using Values = std::vector<double>;  // of the channels
  const Values zero(std::size_t(reflectance.front().channels), 0.0);
  std::vector<std::vector<Values>> seen_values;  // by point and frame; empty: not seen
  std::vector<Values> means;
  for (const Track& track : patch) {
    std::vector<Values> values(reflectance.size());
    Values mean = zero;
    double count = 0;
    for (std::size_t k = 0; k < reflectance.size(); ++k) {
      if (!seen(track, k)) continue;
      values[k] = channels_at(reflectance[k], track[k][0], track[k][1]);
      for (std::size_t c = 0; c < mean.size(); ++c) mean[c] += values[k][c];
      ++count;
    }
    for (double& channel : mean) channel /= std::max(count, 1.0);
    seen_values.push_back(values);
    means.push_back(mean);
  }
  // The mean of the norm over frames, of frame k against `other(point, k)`.
  const auto norm = [&](std::size_t first, auto other) {
    double total = 0, frames = 0;
    for (std::size_t k = first; k < reflectance.size(); ++k) {
      Values sum = zero;
      std::size_t points = 0;
      for (std::size_t p = 0; p < patch.size(); ++p) {
        const Values &now = seen_values[p][k], &before = other(p, k);
        if (now.empty() || before.empty()) continue;
        for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += now[c] - before[c];
        ++points;
      }
      if (points < kMinPoints) continue;
      double squares = 0;
      for (const double s : sum) squares += s * s;
      total += std::sqrt(squares) / double(points);
      ++frames;
    }
    return frames > 0 ? total / frames : 0.0;
  };
  return {
      norm(1, [&](std::size_t p, std::size_t k) -> const Values& { return seen_values[p][k - 1]; }),
      norm(0, [&](std::size_t p, std::size_t) -> const Values& { return means[p]; })};
}

double jitter(const std::vector<Image>& reflectance, const Image& mask) {
  if (reflectance.size() < 2) return 0.0;
  std::vector<double> before = log_values(reflectance[0], mask, true), squares(before.size(), 0.0);
  for (std::size_t k = 1; k < reflectance.size(); ++k) {
    std::vector<double> now = log_values(reflectance[k], mask, true);
    for (std::size_t i = 0; i < now.size(); ++i)
      squares[i] += (now[i] - before[i]) * (now[i] - before[i]);
    before.swap(now);
  }
  double total = 0;
  for (double v : squares) total += std::sqrt(v / (2 * double(reflectance.size() - 1)));
  return squares.empty() ? 0.0 : total / double(squares.size());
}

Image static_pixels(const std::vector<Image>& true_reflectance) {
  constexpr float kSame = 0.01F;
  if (true_reflectance.empty()) return {};
  const Image& first = true_reflectance.front();
  Image mask(first.width, first.height, 1, 1.0F);
  for (const Image& r : true_reflectance) {
    detail::check_sizes(r, first, {});
    for (int y = 0; y < first.height; ++y)
      for (int x = 0; x < first.width; ++x)
        for (int c = 0; c < first.channels; ++c)
          if (std::abs(r.at(x, y, c) - first.at(x, y, c)) >
              kSame * std::max(r.at(x, y, c), first.at(x, y, c)))
            mask.at(x, y) = 0;
  }
  return mask;
}

}  // namespace inverse::bench
