// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scale_normalization.hpp"

#include <algorithm>
#include <cmath>

#include "tests/reference/random.hpp"

namespace inverse::reference {
namespace {
constexpr double kPoints = 400;  // about as many
constexpr int kReach = 2;        // cells from a window's center to its border
constexpr int kIterations = 3;
constexpr double kCommonMotion = 0.1;  // weight of the common motion
constexpr double kMismatch = 0.1, kSteep = 0.05, kRenew = 0.003, kDarkest = -3.9, kBlack = -5.3;
constexpr std::size_t kSpan = 64, kOldest = 4;
constexpr uint32_t kCandidates = 8;
constexpr int kRounds = 10;
constexpr double kWidth = 0.02, kNoZoom = 0.1, kMinFound = 0.05, kSameScene = 0.5, kFollow = 0.1,
                 kMoreLight = 0.25, kMeanRate = 1.0 / 64;

constexpr double kGraySlope = 0.05;  // of light, that hardly tells whether its color changed
constexpr double kDim = 0.1;         // darker points hardly have a color to tell by

double mix(double a, double b, double share) { return a + share * (b - a); }

/// ln R/B of a cell before its color was corrected.
double seen_color(const ScaleCell& cell, const LightColor& light) {
  return cell[2] + cell[1] / std::sqrt(3.0) + light.slope * (cell[0] - light.reference);
}
}  // namespace

ScaleNormalization::ScaleNormalization(int width, int height)
    : width_(width), height_(height), spacing_(std::max(1.0, std::sqrt(width * height / kPoints))) {
  columns_ = std::max(1, static_cast<int>(width / spacing_));
  rows_ = std::max(1, static_cast<int>(height / spacing_));
  points_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
}

std::vector<ScaleCell> ScaleNormalization::smoothed(const std::vector<ScaleCell>& cells) const {
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(std::clamp(y, 0, height_ - 1) * width_ +
                                    std::clamp(x, 0, width_ - 1));
  };
  constexpr double kWeights[] = {1 / 16.0, 4 / 16.0, 6 / 16.0, 4 / 16.0, 1 / 16.0};
  std::vector<ScaleCell> result = cells;
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x)
      for (std::size_t k = 0; k < 3; ++k) {
        double sum = 0;
        for (int j = -2; j <= 2; ++j)
          for (int i = -2; i <= 2; ++i)
            sum += kWeights[i + 2] * kWeights[j + 2] * cells[at(x + i, y + j)][k];
        result[at(x, y)][k] = sum;
      }
  return result;
}

ScaleCell ScaleNormalization::between(const std::vector<ScaleCell>& cells, double x,
                                      double y) const {
  const auto at = [&](int column, int row) {
    return cells[static_cast<std::size_t>(std::clamp(row, 0, height_ - 1)) *
                     static_cast<std::size_t>(width_) +
                 static_cast<std::size_t>(std::clamp(column, 0, width_ - 1))];
  };
  const int low_x = static_cast<int>(std::floor(x)), low_y = static_cast<int>(std::floor(y));
  const ScaleCell a = at(low_x, low_y), b = at(low_x + 1, low_y), c = at(low_x, low_y + 1),
                  d = at(low_x + 1, low_y + 1);
  ScaleCell result{};
  for (std::size_t k = 0; k < 4; ++k)
    result[k] = mix(mix(a[k], b[k], x - low_x), mix(c[k], d[k], x - low_x), y - low_y);
  return result;
}

std::array<double, 2> ScaleNormalization::sparse_place(uint32_t index,
                                                       const std::vector<Point>& others) const {
  std::array<double, 2> best{};
  double farthest = -1;
  for (uint32_t k = 0; k < kCandidates; ++k) {
    const std::array<std::uint32_t, 3> random = pcg3d(index, frames_, k);
    const std::array<double, 2> place{(random[0] >> 8) / 16777216.0 * (width_ - 1),
                                      (random[1] >> 8) / 16777216.0 * (height_ - 1)};
    double nearest = 1e9;
    for (const Point& other : others)
      if (!other.history.empty())
        nearest =
            std::min(nearest, std::pow(other.x - place[0], 2) + std::pow(other.y - place[1], 2));
    if (nearest <= farthest) continue;
    farthest = nearest;
    best = place;
  }
  return best;
}

ScaleNormalization::Sample ScaleNormalization::track(Point& point, uint32_t index,
                                                     const std::vector<Point>& others,
                                                     const std::vector<ScaleCell>& cells,
                                                     const LightColor& light) const {
  double offset = offset_;
  if (!has_history_ || point.history.empty()) {
    const auto columns = static_cast<uint32_t>(columns_);
    const std::array<double, 2> place =
        has_history_
            ? sparse_place(index, others)
            : std::array{std::min((index % columns + 0.5) * spacing_ - 0.5, width_ - 1.0),
                         std::min((index / columns + 0.5) * spacing_ - 0.5, height_ - 1.0)};
    point = {place[0], place[1], {}};
    offset = mix(offset_, target_, kRenew);
  }
  const ScaleCell past = between(before_, point.x, point.y);
  point.history.push_back({past[3] + offset, past[0], seen_color(past, light_), exposure_});
  if (point.history.size() > kSpan) point.history.pop_front();

  // Lucas and Kanade, the means of the windows removed.
  Sample sample{};
  sample.from[0] = point.x - (width_ - 1) / 2.0;
  sample.from[1] = point.y - (height_ - 1) / 2.0;
  const std::array<double, 2> common = motion_.at(sample.from[0], sample.from[1]);
  double dx = common[0], dy = common[1], xx = 0, yy = 0, xy = 0, mismatch = 0;
  constexpr double kCount = (2 * kReach + 1) * (2 * kReach + 1);
  for (int pass = 0; pass <= kIterations; ++pass) {
    double sum_x = 0, sum_y = 0, differ = 0;
    std::array<double, 3> slope_x{}, slope_y{}, change{};
    xx = yy = xy = 0;
    for (int j = -kReach; j <= kReach; ++j)
      for (int i = -kReach; i <= kReach; ++i) {
        const double x = point.x + i, y = point.y + j;
        const ScaleCell was = between(before_, x, y), is = between(cells, x + dx, y + dy);
        const ScaleCell left = between(before_, x - 1, y), right = between(before_, x + 1, y);
        const ScaleCell up = between(before_, x, y - 1), down = between(before_, x, y + 1);
        for (std::size_t k = 0; k < 3; ++k) {
          const double gx = (right[k] - left[k]) / 2, gy = (down[k] - up[k]) / 2;
          const double step = was[k] - is[k];
          xx += gx * gx;
          yy += gy * gy;
          xy += gx * gy;
          sum_x += step * gx;
          sum_y += step * gy;
          differ += step * step;
          slope_x[k] += gx;
          slope_y[k] += gy;
          change[k] += step;
        }
      }
    const auto dot = [](const std::array<double, 3>& a, const std::array<double, 3>& b) {
      return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    };
    mismatch = (differ - dot(change, change) / kCount) / kCount;
    if (pass == kIterations) break;
    const double toward_x =
        sum_x - dot(slope_x, change) / kCount + kCommonMotion * (common[0] - dx);
    const double toward_y =
        sum_y - dot(slope_y, change) / kCount + kCommonMotion * (common[1] - dy);
    const double a = xx + kCommonMotion, b = yy + kCommonMotion, det = a * b - xy * xy;
    dx += std::clamp((b * toward_x - xy * toward_y) / det, -1.0, 1.0);
    dy += std::clamp((a * toward_y - xy * toward_x) / det, -1.0, 1.0);
  }
  point.x += dx;
  point.y += dy;
  sample.motion[0] = dx;
  sample.motion[1] = dy;
  const ScaleCell cell = between(cells, point.x, point.y);
  const bool found = point.x >= 1 && point.y >= 1 && point.x <= width_ - 2 &&
                     point.y <= height_ - 2 &&
                     mismatch <= kMismatch * kMismatch + kSteep * (xx + yy) / kCount;
  sample.found = found && cell[0] > kBlack;
  sample.bright = cell[0] > kDarkest;
  const double difference = (xx - yy) / 2, texture = (xx + yy) / 2 - std::hypot(difference, xy);
  sample.texture = texture > 0 ? texture : 0;
  const std::size_t count = std::min(point.history.size(), kOldest);
  Past mean{};
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t j = 0; j < mean.size(); ++j)
      mean[j] += point.history[k][j] / static_cast<double>(count);
  sample.offset = mean[0] - cell[3];
  // Along the line of light's color brightness changes with color; the exposure changes without.
  const double brighter = cell[0] - mean[1], redder = seen_color(cell, light) - mean[2];
  const double along = redder * light.slope / (light.slope * light.slope + kGraySlope * kGraySlope);
  sample.exposure =
      mean[3] + std::clamp(brighter - along, std::min(brighter, 0.0), std::max(brighter, 0.0));
  sample.weight = sample.found ? static_cast<double>(point.history.size()) / kSpan : 0;
  const double seen = std::exp(cell[0]);
  sample.exposure_weight = sample.weight * std::pow(seen / (seen + kDim), 2);
  if (!found) point.history.clear();
  return sample;
}

void ScaleNormalization::fit(Motion& motion, const std::vector<Sample>& samples,
                             double weight_of_none) {
  double weights = 0, mean[4] = {}, square = 0, along = 0, across = 0;
  for (const Sample& s : samples) {
    if (!s.found) continue;
    const std::array<double, 2> common = motion.at(s.from[0], s.from[1]);
    const double weight = s.texture / (1 + std::pow(s.motion[0] - common[0], 2) +
                                       std::pow(s.motion[1] - common[1], 2));
    weights += weight;
    for (std::size_t k : {0U, 1U}) {
      mean[k] += weight * s.motion[k];
      mean[2 + k] += weight * s.from[k];
    }
    square += weight * (s.from[0] * s.from[0] + s.from[1] * s.from[1]);
    along += weight * (s.from[0] * s.motion[0] + s.from[1] * s.motion[1]);
    across += weight * (s.from[0] * s.motion[1] - s.from[1] * s.motion[0]);
  }
  if (!(weights > 1e-6)) return;
  for (double& m : mean) m /= weights;
  const double spread = square - weights * (mean[2] * mean[2] + mean[3] * mean[3]) + weight_of_none;
  motion.zoom = (along - weights * (mean[2] * mean[0] + mean[3] * mean[1])) / spread;
  motion.turn = (across - weights * (mean[2] * mean[1] - mean[3] * mean[0])) / spread;
  const std::array<double, 2> rest = Motion{0, 0, motion.zoom, motion.turn}.at(mean[2], mean[3]);
  motion.x = mean[0] - rest[0];
  motion.y = mean[1] - rest[1];
}

double ScaleNormalization::update(const std::vector<ScaleCell>& input, const ScaleTarget& target,
                                  bool carries, double white_level, const LightColor& light) {
  const double log_white = log_white_ = std::log(white_level);
  const std::vector<ScaleCell> cells = smoothed(input);
  std::vector<Sample> samples;
  if (!before_.empty()) {
    const std::vector<Point> others = points_;
    for (std::size_t i = 0; i < points_.size(); ++i)
      samples.push_back(track(points_[i], static_cast<uint32_t>(i), others, cells, light));
    ++frames_;
  }
  double bright = 0, found_texture = 0, texture = 0;
  found_ = 0;
  for (const Sample& sample : samples) {
    bright += sample.bright;
    found_ += sample.found;
    found_texture += sample.found ? sample.texture : 0;
    texture += sample.texture;
  }
  bright /= static_cast<double>(points_.size());
  found_ /= static_cast<double>(points_.size());
  const bool known = known_ && (carries || found_texture > kSameScene * texture);

  // Pseudo-Huber means of the offsets and exposures, and the common motion.
  double offset = offset_, exposure = exposure_;
  Motion motion = motion_;
  const double center = ((width_ - 1.0) * (width_ - 1) + (height_ - 1.0) * (height_ - 1)) / 4;
  for (int round = 0; round < kRounds; ++round) {
    const auto center_on = [&](double& mean, double Sample::*value, double Sample::*weights_of) {
      double sum = 0, weights = 0;
      for (const Sample& sample : samples) {
        if (!sample.found) continue;
        const double weight = sample.*weights_of / std::hypot(1, (sample.*value - mean) / kWidth);
        sum += weight * sample.*value;
        weights += weight;
      }
      if (weights > 1e-6) mean = sum / weights;
    };
    center_on(offset, &Sample::offset, &Sample::weight);
    center_on(exposure, &Sample::exposure, &Sample::exposure_weight);
    fit(motion, samples, kNoZoom * center);
  }
  before_ = cells;
  light_ = light;
  if (target.dark) {
    if (!known) offset_ = white_ = log_white_ = 0;
    known_ = known;
    target_ = offset_;
    motion_ = {};
    has_history_ = false;
    return known ? log_white + offset_ : 0;
  }
  const bool tracked = known && found_ > kMinFound;
  if (tracked) {
    white_ += exposure - exposure_;
    exposure_ = exposure;
  }
  if (!known) {
    offset = target.offset;
    white_ = target.brightest - offset;
  } else if (samples.empty()) {
    offset = offset_;
  } else if (!tracked) {
    offset = mix(offset_, target.offset, kFollow);
  } else if (bright > bright_ && bright_ > 0) {
    const double growth =
        std::max((bright - bright_) / bright - kMoreLight, 0.0) / (1 - kMoreLight);
    const double shift = kFollow * growth * (target.offset - offset);
    offset += shift;
    white_ = mix(white_, target.brightest - offset, kFollow * growth);
    for (Point& point : points_)
      for (Past& past : point.history) past[0] += shift;
  }
  bright_ = known && bright_ > 0 ? mix(bright_, bright, kMeanRate) : bright;
  motion_ = tracked ? motion : Motion{};
  has_history_ = tracked;
  known_ = true;
  offset_ = offset;
  target_ = target.offset;
  return log_white + offset_;
}

}  // namespace inverse::reference
