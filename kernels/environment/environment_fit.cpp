// SPDX-License-Identifier: LGPL-2.1-or-later
#include "environment_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace inverse {
namespace {

using Matrix = Eigen::Matrix<double, EnvironmentFit::kTerms, EnvironmentFit::kTerms>;
using Vector = Eigen::Matrix<double, EnvironmentFit::kTerms, 1>;

constexpr double kPi = std::numbers::pi;
/// Reflection of L_lm by a white diffuse surface.
constexpr double kGain[] = {1, 2. / 3, 2. / 3, 2. / 3, 1. / 4, 1. / 4, 1. / 4, 1. / 4, 1. / 4};
/// Variance of L_lm relative to L_00²: means over 27 maps of rooms, studios and streets.
constexpr double kVariance[] = {1, .27, .27, .27, .18, .18, .18, .18, .18};
/// Number of independent errors in a view; errors of neighboring points are correlated.
constexpr double kIndependent = 30;
/// Relative variance of L_00 about that of the mirror image, and of the three colors about gray.
constexpr double kLevelVariance = 100, kColorVariance = .1;
/// Weight above which a texel is not filled from its neighbors.
constexpr float kCertain = 0.05F;
constexpr double kBlack = 1e-4;     // light, linear, that is none
constexpr float kBrightest = 1e6F;  // radiance
constexpr double kDark = 0.03;      // albedo below which diffuse light does not measure the lamps

double mean3(const std::array<double, 3>& v) { return (v[0] + v[1] + v[2]) / 3; }

bool finite(const EnvironmentFit::Point& p) {
  for (const float v :
       {p.normal[0], p.normal[1], p.normal[2], p.mirror, p.diffuse[0], p.diffuse[1], p.diffuse[2]})
    if (!std::isfinite(v)) return false;
  return true;
}

/// Points at the outline contain background, and their normals are the least accurate.
float facing_weight(float facing) {
  const float t = std::clamp((facing - 0.05F) / 0.25F, 0.0F, 1.0F);
  return t * t * (3 - 2 * t);
}

/// Rows beyond a pole are mirrored by half a turn; columns wrap around.
size_t wrapped(int column, int row, int width, int height) {
  if (row < 0 || row >= height) column += width / 2;
  row = row < 0 ? -1 - row : row >= height ? 2 * height - 1 - row : row;
  return static_cast<size_t>(row) * width + static_cast<size_t>((column + 2 * width) % width);
}

/// Fills values of little weight from a coarser map (pull-push); `weight` is 0…1.
void fill(std::vector<float>& value, const std::vector<float>& weight, int width, int height) {
  const int half_width = width / 2, half_height = height / 2;
  if (half_height < 1) return;
  std::vector<float> coarse(size_t(half_width) * half_height), sure(coarse.size());
  for (int row = 0; row < half_height; ++row)
    for (int column = 0; column < half_width; ++column) {
      float sum = 0, all = 0;
      for (int k = 0; k < 4; ++k) {
        const size_t at = size_t(2 * row + k / 2) * width + 2 * column + k % 2;
        sum += weight[at] * value[at];
        all += weight[at];
      }
      const size_t to = size_t(row) * half_width + column;
      coarse[to] = all > 0 ? sum / all : 0;
      sure[to] = std::min(1.0F, all);
    }
  if (std::all_of(weight.begin(), weight.end(), [](float w) { return w >= 1; })) return;
  if (half_height > 1) {
    fill(coarse, sure, half_width, half_height);
  } else {
    float sum = 0, all = 0;
    for (size_t i = 0; i < coarse.size(); ++i) sum += sure[i] * coarse[i], all += sure[i];
    for (size_t i = 0; i < coarse.size(); ++i)
      coarse[i] = sure[i] * coarse[i] + (1 - sure[i]) * (all > 0 ? sum / all : 0);
  }
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const size_t at = size_t(row) * width + column;
      if (weight[at] >= 1) continue;
      // Bilinear between the four nearest.
      const int near_column = column / 2, near_row = row / 2;
      const int far_column = near_column + (column % 2 ? 1 : -1),
                far_row = near_row + (row % 2 ? 1 : -1);
      const auto at_coarse = [&](int x, int y) {
        return coarse[wrapped(x, y, half_width, half_height)];
      };
      const float around =
          (9 * at_coarse(near_column, near_row) + 3 * at_coarse(far_column, near_row) +
           3 * at_coarse(near_column, far_row) + at_coarse(far_column, far_row)) /
          16;
      value[at] = weight[at] * value[at] + (1 - weight[at]) * around;
    }
}

}  // namespace

EnvironmentFit::Terms EnvironmentFit::harmonics(double x, double y, double z) {
  return {0.28209479177387814,
          0.4886025119029199 * y,
          0.4886025119029199 * z,
          0.4886025119029199 * x,
          1.0925484305920792 * x * y,
          1.0925484305920792 * y * z,
          0.31539156525252005 * (3 * z * z - 1),
          1.0925484305920792 * x * z,
          0.5462742152960396 * (x * x - y * y)};
}

EnvironmentFit::EnvironmentFit() : texels_(size_t{kWidth} * kHeight) {
  const Environment map({kWidth, kHeight}, std::vector<float>(texels_.size() * 3, 0.0F));
  for (uint32_t row = 0; row < kHeight; ++row)
    for (uint32_t column = 0; column < kWidth; ++column) {
      const auto d = map.direction(column + 0.5, row + 0.5);
      const Terms terms = harmonics(d[0], d[1], d[2]);
      Texel& texel = texels_[size_t{row} * kWidth + column];
      texel.solid_angle = static_cast<float>(map.solid_angle(row));
      for (size_t k = 0; k < kTerms; ++k) texel.harmonics[k] = static_cast<float>(terms[k]);
    }
  reset();
}

void EnvironmentFit::reset() {
  count_ = averaged_ = 0;
  weight_ = 0;
  products_.fill(0);
  seen_ = {};
  level_ = {};
  mirror_weight_.assign(texels_.size(), 0);
  mirror_sum_.assign(texels_.size(), 0);
}

void EnvironmentFit::shorten(uint64_t views) {
  count_ = std::min(count_, views);
  averaged_ = std::min(averaged_, views);
}

void EnvironmentFit::add(std::span<const Point> points, const Params& params) {
  std::array<float, kTerms * kTerms> products{};
  std::array<std::array<float, kTerms>, 3> seen{};
  std::array<float, 3> level{};
  std::vector<float> mirror_weight(texels_.size(), 0), mirror_sum(texels_.size(), 0);
  float all = 0;
  size_t used = 0;
  for (const Point& p : points) {
    const auto [x, y, z] = p.normal;
    if (!(z > 0) || !finite(p)) continue;
    ++used;
    const float weight = facing_weight(z);
    if (!p.clipped && weight > 0) {
      const Terms terms = harmonics(x, y, z);
      std::array<float, kTerms> f;
      for (size_t k = 0; k < kTerms; ++k) f[k] = static_cast<float>(kGain[k] * terms[k]);
      for (size_t i = 0; i < kTerms; ++i) {
        const float weighted = weight * f[i];
        for (size_t j = i; j < kTerms; ++j) products[i * kTerms + j] += weighted * f[j];
        for (size_t c = 0; c < 3; ++c) seen[c][i] += weighted * p.diffuse[c];
      }
      for (size_t c = 0; c < 3; ++c) level[c] += weight * p.diffuse[c];
      all += weight;
    }
    // The texel of the direction whose reflection the point shows; the nearest four share it.
    const float rx = 2 * z * x, ry = std::clamp(2 * z * y, -1.0F, 1.0F), rz = 2 * z * z - 1;
    const auto pi = static_cast<float>(kPi);
    const float column = (std::atan2(rx, rz) / (2 * pi) + 0.5F) * kWidth - 0.5F;
    const float row = std::acos(ry) / pi * kHeight - 0.5F;
    const float low_column = std::floor(column), low_row = std::floor(row);
    for (int k = 0; k < 4; ++k) {
      const float across = k % 2 ? column - low_column : 1 - column + low_column;
      const float down = k / 2 ? row - low_row : 1 - row + low_row;
      const size_t at = wrapped(static_cast<int>(low_column) + k % 2,
                                static_cast<int>(low_row) + k / 2, kWidth, kHeight);
      mirror_weight[at] += z * across * down;
      mirror_sum[at] += z * across * down * std::max(p.mirror, 0.0F);
    }
  }
  if (used < kMinPoints) return;
  ++count_;
  averaged_ = std::min<uint64_t>(averaged_ + 1, std::max(params.memory, uint32_t{1}));
  const double share = 1.0 / static_cast<double>(averaged_);
  const auto mix = [share](double& mean, double now) { mean += share * (now - mean); };
  mix(weight_, all);
  for (size_t i = 0; i < kTerms; ++i)
    for (size_t j = 0; j < kTerms; ++j)
      mix(products_[i * kTerms + j], products[std::min(i, j) * kTerms + std::max(i, j)]);
  for (size_t c = 0; c < 3; ++c) {
    mix(level_[c], level[c]);
    for (size_t i = 0; i < kTerms; ++i) mix(seen_[c][i], seen[c][i]);
  }
  const auto scale = static_cast<float>(share);
  for (size_t i = 0; i < texels_.size(); ++i) {
    mirror_weight_[i] += scale * (mirror_weight[i] - mirror_weight_[i]);
    mirror_sum_[i] += scale * (mirror_sum[i] - mirror_sum_[i]);
  }
}

std::vector<float> EnvironmentFit::filled_mirror() const {
  std::vector<float> value(texels_.size()), weight(texels_.size());
  for (size_t i = 0; i < texels_.size(); ++i) {
    value[i] = mirror_weight_[i] > 0 ? mirror_sum_[i] / mirror_weight_[i] : 0;
    weight[i] = std::min(1.0F, mirror_weight_[i] / kCertain);
  }
  fill(value, weight, kWidth, kHeight);
  return value;
}

EnvironmentFit::Terms EnvironmentFit::project(std::span<const float> map, size_t stride) const {
  Terms terms{};
  for (size_t i = 0; i < texels_.size(); ++i) {
    const float value = map[i * stride] * texels_[i].solid_angle;
    for (size_t k = 0; k < kTerms; ++k)
      terms[k] += static_cast<double>(value * texels_[i].harmonics[k]);
  }
  return terms;
}

std::optional<Environment> EnvironmentFit::light(std::array<float, 3> diffuse, float specular,
                                                 const Params& params) const {
  if (!count_) return std::nullopt;
  // The mirror image as light, as far as the object reflects light.
  const double alpha = std::max(0.0, static_cast<double>(specular));
  const double glossy = alpha * alpha / (alpha * alpha + params.glossy * params.glossy);
  std::vector<float> mirror = filled_mirror();
  for (float& v : mirror) v *= static_cast<float>(kPi / std::max(alpha, 1e-3));
  const Terms of_mirror = project(mirror, 1);

  std::array<double, 3> albedo{};
  for (size_t c = 0; c < 3; ++c) albedo[c] = std::clamp(static_cast<double>(diffuse[c]), 0.0, 1.0);
  double square = 0, mean = 0;
  Vector gray = Vector::Zero();
  const Eigen::Map<const Matrix> products(products_.data());
  const double per_point = weight_ > 0 ? 1 / weight_ : 0;
  for (size_t c = 0; c < 3; ++c) {
    square += albedo[c] * albedo[c];
    mean += albedo[c] * level_[c] * per_point;
    gray += albedo[c] * per_point * Eigen::Map<const Vector>(seen_[c].data());
  }
  // The mean light, to which the prior's variances refer.
  const bool dark = square < 3 * kDark * kDark;
  const double level = dark ? glossy * of_mirror[0] : mean / square / harmonics(0, 0, 1)[0];
  if (!(level > kBlack)) return std::nullopt;

  // Gray solution: (Σ m² A + Λ) L = Σ m b + Λ L_mirror, Λ by variance; noise refers to the mean.
  const double image = std::max(mean / std::max(std::sqrt(3 * square), 1e-3), 0.02);
  const double points = std::max(weight_, 1e-3);
  const double independent = kIndependent * points / (points + 200);
  const double error = 3 * std::pow(params.noise * image, 2) / independent;
  Vector prior = Vector::Zero();
  Matrix precision = Matrix::Zero();
  for (size_t k = 0; k < kTerms; ++k) {
    prior[k] =
        k ? (of_mirror[0] > kBlack ? glossy * level * of_mirror[k] / of_mirror[0] : 0) : level;
    const double variance = (k ? 1 : kLevelVariance) * kVariance[k] * level * level;
    precision(k, k) = error / variance;
  }
  const Matrix normal_equations = square * per_point * products + precision;
  const Eigen::LDLT<Matrix> factors(normal_equations);
  const Vector low_gray = factors.solve(gray + precision * prior);

  // Deviation of the colors from gray.
  std::array<Terms, 3> low{};
  for (size_t c = 0; c < 3; ++c) {
    const double m = albedo[c];
    const Matrix own = m * m * per_point * products +
                       precision / (3 * kColorVariance) *
                           Eigen::DiagonalMatrix<double, kTerms>(
                               (Vector() << kLevelVariance, 1, 1, 1, 1, 1, 1, 1, 1).finished());
    const Vector rest = m * per_point * Eigen::Map<const Vector>(seen_[c].data()) -
                        m * m * per_point * products * low_gray;
    const Vector solution = low_gray + Vector(Eigen::LDLT<Matrix>(own).solve(rest));
    for (size_t k = 0; k < kTerms; ++k) low[c][k] = solution[k];
  }

  std::array<double, 3> tint{};
  for (size_t c = 0; c < 3; ++c) tint[c] = std::max(low[c][0], 0.0);
  const double white = std::max(mean3(tint), 1e-9);
  for (double& t : tint) t = std::clamp(t / white, 0.0, 3.0);

  // Sum of low and high frequencies, clamped at 0; the clamping's low frequencies are subtracted
  // again.
  std::vector<float> rgb(3 * texels_.size());
  std::array<Terms, 3> added = low;
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    for (size_t i = 0; i < texels_.size(); ++i) {
      const auto& y = texels_[i].harmonics;
      float high = mirror[i];
      for (size_t k = 0; k < kTerms; ++k) high -= static_cast<float>(of_mirror[k]) * y[k];
      high *= static_cast<float>(glossy);
      for (size_t c = 0; c < 3; ++c) {
        float value = high * static_cast<float>(tint[c]);
        for (size_t k = 0; k < kTerms; ++k) value += static_cast<float>(added[c][k]) * y[k];
        rgb[3 * i + c] = value > 0 ? std::min(value, kBrightest) : 0;  // NaN, too
      }
    }
    if (round + 1 == kRounds) break;
    for (size_t c = 0; c < 3; ++c) {
      const Terms got = project(std::span(rgb).subspan(c), 3);
      for (size_t k = 0; k < kTerms; ++k) added[c][k] += low[c][k] - got[k];
    }
  }
  return Environment({kWidth, kHeight}, std::move(rgb), "the light of limematerial");
}

}  // namespace inverse
