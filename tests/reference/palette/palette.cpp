// SPDX-License-Identifier: LGPL-2.1-or-later
#include "palette.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/reference/random.hpp"

namespace inverse::reference {
namespace {

constexpr double kEmptyBin = 1e-3;  // bins that decayed below this many pixels are dropped
constexpr double kColorFloor = 1e-3;

double squared_distance(const Vec3& a, const Vec3& b) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum;
}

Vec3 mean_color(const HistogramBin& bin) {
  return {bin[1] / bin[0], bin[2] / bin[0], bin[3] / bin[0]};
}

double mean(const Vec3& color) { return (color[0] + color[1] + color[2]) / 3; }

double chroma_distance(const Vec3& a, const Vec3& b, double floor) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) {
    const double d = (a[c] + floor) / (mean(a) + floor) - (b[c] + floor) / (mean(b) + floor);
    sum += d * d;
  }
  return std::sqrt(sum);
}

}  // namespace

double Palette::frame_scale(const Plane& log_reflectance) const {
  std::vector<std::uint32_t> counts(kScaleBins, 0);
  for (const Vec4& r : log_reflectance.data) {
    for (int c = 0; c < 3; ++c) {
      const double position = std::clamp((r[c] + 16) * (kScaleBins / 32.0), 0.0, kScaleBins - 1.0);
      ++counts[static_cast<std::size_t>(position)];
    }
  }
  // The quantile, linear inside its bin.
  const double target = params_.white_quantile * 3 * static_cast<double>(log_reflectance.size());
  double below = 0;
  for (int bin = 0; bin < kScaleBins; ++bin) {
    if (counts[bin] != 0 && below + counts[bin] >= target) {
      const double position = bin + (target - below) / counts[bin];
      return std::log(params_.white_level) - (position * (32.0 / kScaleBins) - 16);
    }
    below += counts[bin];
  }
  return 0;
}

std::vector<HistogramBin> Palette::count(const Plane& log_reflectance) const {
  std::vector<HistogramBin> bins(kHistogramBins * kHistogramBins * kHistogramBins, HistogramBin{});
  for (const Vec4& r : log_reflectance.data) {
    Vec3 color{};
    std::size_t index = 0;
    for (int c = 0; c < 3; ++c) {
      color[c] = std::clamp(std::exp(r[c] + scale_), 0.0, 1.0);
      const double bin = std::min(std::floor(color[c] * kHistogramBins), kHistogramBins - 1.0);
      index = index * kHistogramBins + static_cast<std::size_t>(bin);
    }
    bins[index][0] += 1;
    for (int c = 0; c < 3; ++c) bins[index][c + 1] += color[c];
  }
  return bins;
}

void Palette::update(const Plane& log_reflectance) {
  const double scale = frame_scale(log_reflectance);
  scale_ = frame_ == 0 ? scale : scale_ + params_.decay * (scale - scale_);
  const std::vector<HistogramBin> bins = count(log_reflectance);
  if (frame_ == 0) {
    histogram_ = bins;
  } else {
    for (std::size_t n = 0; n < bins.size(); ++n) {
      const double share = bins[n][0] > 0 ? params_.decay : params_.fade;
      for (int k = 0; k < 4; ++k) {
        histogram_[n][k] += share * (bins[n][k] - histogram_[n][k]);
      }
      if (histogram_[n][0] < kEmptyBin) histogram_[n] = {};
    }
  }
  seed_clusters();
  lloyd();
  merge();
  ++frame_;
}

void Palette::seed_clusters() {
  // k-means++ for clusters without pixels: all on the first frame, later those that lost theirs.
  clusters_.resize(static_cast<std::size_t>(params_.clusters));
  for (std::size_t k = 0; k < clusters_.size(); ++k) {
    if (clusters_[k].weight > 0) continue;
    std::vector<double> mass(histogram_.size(), 0);
    double total = 0;
    for (std::size_t n = 0; n < histogram_.size(); ++n) {
      if (histogram_[n][0] <= 0) continue;
      double nearest = std::numeric_limits<double>::infinity();
      bool near = false;
      for (const Cluster& other : clusters_) {
        if (other.weight > 0) {
          near = near || (frame_ > 0 && chroma_distance(mean_color(histogram_[n]), other.color,
                                                        params_.chroma_floor) < params_.apart);
          nearest = std::min(nearest, squared_distance(mean_color(histogram_[n]), other.color));
        }
      }
      // Closer than a bin's width: a duplicate.
      if (near || nearest * kHistogramBins * kHistogramBins < 1) continue;
      mass[n] = histogram_[n][0] * (std::isinf(nearest) ? 1 : nearest);
      total += mass[n];
    }
    const double uniform =
        (pcg3d(static_cast<std::uint32_t>(k), frame_, params_.seed)[0] >> 8) / 16777216.0;
    double below = 0;
    for (std::size_t n = 0; n < mass.size() && total > 0; ++n) {
      below += mass[n];
      if (mass[n] > 0 && below > uniform * total) {
        clusters_[k].color = mean_color(histogram_[n]);
        clusters_[k].weight = 1;
        break;
      }
    }
  }
}

void Palette::lloyd() {
  for (int iteration = 0; iteration < params_.iterations; ++iteration) {
    std::vector<Vec4> sums(clusters_.size(), Vec4{});
    for (const HistogramBin& bin : histogram_) {
      if (bin[0] <= 0) continue;
      std::size_t best = 0;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < clusters_.size(); ++k) {
        if (clusters_[k].weight <= 0) continue;
        const double distance = squared_distance(mean_color(bin), clusters_[k].color);
        if (distance < nearest) {
          nearest = distance;
          best = k;
        }
      }
      for (int c = 0; c < 4; ++c) sums[best][c] += bin[c];
    }
    for (std::size_t k = 0; k < clusters_.size(); ++k) {
      if (sums[k][0] > 0) clusters_[k].color = mean_color(sums[k]);
      clusters_[k].weight = sums[k][0];
    }
  }
}

void Palette::merge() {
  for (std::size_t k = 0; k < clusters_.size(); ++k) clusters_[k].alias = static_cast<int>(k);
  for (std::size_t a = 0; a < clusters_.size(); ++a) {
    Cluster& into = clusters_[a];
    if (into.weight <= 0 || into.alias != static_cast<int>(a)) continue;
    Vec4 sum{};
    for (std::size_t b = a; b < clusters_.size(); ++b) {
      Cluster& other = clusters_[b];
      if (other.weight <= 0 || other.alias != static_cast<int>(b)) continue;
      const double floor = params_.chroma_floor;
      const double mean_a = mean(into.color) + floor;
      const double mean_b = mean(other.color) + floor;
      const double chroma = chroma_distance(into.color, other.color, floor);
      // Chromaticity alone would merge black, gray and white.
      if (b != a && (chroma >= params_.tau_cc ||
                     std::abs(std::log(mean_a / mean_b)) >= params_.tau_intensity)) {
        continue;
      }
      other.alias = static_cast<int>(a);
      for (int c = 0; c < 3; ++c) sum[c] += other.weight * other.color[c];
      sum[3] += other.weight;
    }
    for (int c = 0; c < 3; ++c) into.merged[c] = sum[c] / sum[3];
  }
}

std::vector<Vec3> Palette::log_colors() const {
  std::vector<Vec3> colors;
  for (std::size_t k = 0; k < clusters_.size(); ++k) {
    const Cluster& cluster = clusters_[k];
    if (cluster.weight <= 0 || cluster.alias != static_cast<int>(k)) continue;
    Vec3 color{};
    for (int c = 0; c < 3; ++c)
      color[c] = std::log(std::max(cluster.merged[c], kColorFloor)) - scale_;
    colors.push_back(color);
  }
  return colors;
}

std::size_t nearest_color(const Vec4& r, const std::vector<Vec3>& colors) {
  std::size_t best = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < colors.size(); ++k) {
    const double distance = squared_distance({r[0], r[1], r[2]}, colors[k]);
    if (distance < nearest) {
      nearest = distance;
      best = k;
    }
  }
  return best;
}

Plane clustered(const Plane& r, const std::vector<Vec3>& colors) {
  if (colors.empty()) return {};
  Plane result(r.width, r.height);
  for (std::size_t n = 0; n < r.size(); ++n) {
    const std::size_t nearest = nearest_color(r.data[n], colors);
    const Vec3& color = colors[nearest];
    result.data[n] = {color[0], color[1], color[2], static_cast<double>(nearest)};
  }
  return result;
}

}  // namespace inverse::reference
