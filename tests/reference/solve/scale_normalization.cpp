// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scale_normalization.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {
constexpr double kPoints = 400;  // about as many
constexpr int kReach = 2;        // cells from a window's center to its border
constexpr int kIterations = 3;
constexpr double kCommonMotion = 0.1;  // weight of the common motion
constexpr double kMismatch = 0.1, kSteep = 0.05, kColorChange = 0.3;
constexpr double kTexture = 0.1, kTrusted = 10, kRenew = 0.003, kDarkest = -3.9;
constexpr int kRounds = 6;
constexpr double kWidth = 0.1, kFewest = 0.05, kFollow = 0.1, kMoreLight = 0.25;
constexpr double kRemember = 1.0 / 64;

double mix(double a, double b, double share) { return a + share * (b - a); }
}  // namespace

ScaleNormalization::ScaleNormalization(int width, int height)
    : width_(width),
      height_(height),
      spacing_(std::max(2.0, std::round(std::sqrt(width * height / kPoints)))) {
  columns_ = std::max(1, static_cast<int>(width / spacing_));
  rows_ = std::max(1, static_cast<int>(height / spacing_));
  points_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
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

ScaleNormalization::Sample ScaleNormalization::track(Point& point, int index,
                                                     const std::vector<ScaleCell>& cells) const {
  point.reflectance += shift_;
  if (!goes_on_ || point.frames < 0) {
    point.x = std::min((index % columns_ + 0.5) * spacing_ - 0.5, width_ - 1.0);
    point.y = std::min((index / columns_ + 0.5) * spacing_ - 0.5, height_ - 1.0);
    const ScaleCell cell = between(before_, point.x, point.y);
    point.reflectance = cell[3] + mix(offset_, wanted_, kRenew);
    point.color[0] = cell[1];
    point.color[1] = cell[2];
    point.frames = 0;
  }
  // Lucas and Kanade, the mean of log intensity removed.
  double dx = motion_[0], dy = motion_[1], xx = 0, yy = 0, xy = 0, mismatch = 0;
  constexpr double kCount = (2 * kReach + 1) * (2 * kReach + 1);
  for (int pass = 0; pass <= kIterations; ++pass) {
    double sum_x = 0, sum_y = 0, slope_x = 0, slope_y = 0, brighter = 0, differ = 0;
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
          if (k > 0) continue;
          slope_x += gx;
          slope_y += gy;
          brighter += step;
        }
      }
    mismatch = (differ - brighter * brighter / kCount) / kCount;
    if (pass == kIterations) break;
    const double pull_x = sum_x - slope_x * brighter / kCount + kCommonMotion * (motion_[0] - dx);
    const double pull_y = sum_y - slope_y * brighter / kCount + kCommonMotion * (motion_[1] - dy);
    const double a = xx + kCommonMotion, b = yy + kCommonMotion, det = a * b - xy * xy;
    dx += std::clamp((b * pull_x - xy * pull_y) / det, -1.0, 1.0);
    dy += std::clamp((a * pull_y - xy * pull_x) / det, -1.0, 1.0);
  }
  point.x += dx;
  point.y += dy;
  const ScaleCell cell = between(cells, point.x, point.y);
  Sample sample{};
  sample.found = point.x >= 1 && point.y >= 1 && point.x <= width_ - 2 && point.y <= height_ - 2 &&
                 mismatch <= kMismatch * kMismatch + kSteep * (xx + yy) / kCount &&
                 std::abs(cell[1] - point.color[0]) <= kColorChange &&
                 std::abs(cell[2] - point.color[1]) <= kColorChange;
  sample.bright = cell[0] > kDarkest;
  const double difference = (xx - yy) / 2;
  const double texture =
      std::max((xx + yy) / 2 - std::sqrt(difference * difference + xy * xy), 0.0);
  point.frames = sample.found ? point.frames + 1 : -1;
  sample.offset = point.reflectance - cell[3];
  sample.weight = sample.found && sample.bright
                      ? std::min(point.frames / kTrusted, 1.0) * texture / (texture + kTexture)
                      : 0;
  sample.texture = sample.found ? texture : 0;
  sample.motion[0] = dx;
  sample.motion[1] = dy;
  sample.found = sample.found && sample.bright;
  return sample;
}

double ScaleNormalization::update(const std::vector<ScaleCell>& cells, const Wanted& wanted,
                                  bool carries, double white_level, bool frozen) {
  const double log_white = std::log(white_level);
  std::vector<Sample> samples;
  if (!before_.empty())
    for (std::size_t i = 0; i < points_.size(); ++i)
      samples.push_back(track(points_[i], static_cast<int>(i), cells));
  double offset = offset_, motion[2] = {motion_[0], motion_[1]}, bright = 0;
  found_ = 0;
  for (const Sample& sample : samples) {
    bright += sample.bright;
    found_ += sample.found;
  }
  bright /= static_cast<double>(points_.size());
  found_ /= static_cast<double>(points_.size());
  for (int round = 0; round < kRounds; ++round) {
    double sum = 0, weights = 0, moved[2] = {}, steady = 0;
    for (const Sample& sample : samples) {
      if (!sample.found) continue;
      const double away = (sample.offset - offset) / kWidth;
      const double weight = sample.weight / (1 + away * away);
      sum += weight * sample.offset;
      weights += weight;
      const double apart[2] = {sample.motion[0] - motion[0], sample.motion[1] - motion[1]};
      const double share = sample.texture / (1 + apart[0] * apart[0] + apart[1] * apart[1]);
      moved[0] += share * sample.motion[0];
      moved[1] += share * sample.motion[1];
      steady += share;
    }
    if (weights > 1e-6) offset = sum / weights;
    if (steady > 1e-6)
      for (int k : {0, 1}) motion[k] = moved[k] / steady;
  }
  before_ = cells;
  shift_ = 0;
  const bool known = carries && known_;
  if (wanted.dark) {
    if (!known) offset_ = 0;
    known_ = known;
    wanted_ = offset_;
    motion_[0] = motion_[1] = 0;
    goes_on_ = false;
    return known ? log_white + offset_ : 0;
  }
  const bool follows = known && found_ > kFewest;
  if (!known) {
    offset = wanted.offset;
  } else if (frozen || samples.empty()) {
    offset = offset_;
  } else if (!follows) {
    offset = mix(offset_, wanted.offset, kFollow);
  } else if (bright > bright_ && bright_ > 0) {
    const double growth =
        std::max((bright - bright_) / bright - kMoreLight, 0.0) / (1 - kMoreLight);
    shift_ = kFollow * growth * (wanted.offset - offset);
    offset += shift_;
  }
  bright_ = known && bright_ > 0 ? mix(bright_, bright, kRemember) : bright;
  for (int k : {0, 1}) motion_[k] = follows ? motion[k] : 0;
  goes_on_ = follows;
  known_ = true;
  offset_ = offset;
  wanted_ = wanted.offset;
  return log_white + offset_;
}

}  // namespace inverse::reference
