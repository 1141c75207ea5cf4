// SPDX-License-Identifier: LGPL-2.1-or-later
#include "environment.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/error.hpp"

namespace inverse {
namespace {

constexpr double kPi = std::numbers::pi;

std::string size_of(Extent extent) {
  return std::to_string(extent.width) + "x" + std::to_string(extent.height);
}

/// 1 well inside of a box of these half sizes (radian) around a direction, 0 outside, smooth
/// between.
double soft_box(double azimuth, double elevation, double at_azimuth, double at_elevation,
                double half_width, double half_height) {
  const double across = std::remainder(azimuth - at_azimuth, 2 * kPi) * std::cos(elevation);
  const auto inside = [](double distance, double half) {
    const double t = std::clamp((half - std::fabs(distance)) / (0.4 * half) + 0.5, 0.0, 1.0);
    return t * t * (3 - 2 * t);
  };
  return inside(across, half_width) * inside(elevation - at_elevation, half_height);
}

}  // namespace

void Environment::check_size(Extent extent, const std::string& name) {
  if (extent.height < 2 || extent.width != 2 * extent.height || extent.width > kMaxWidth)
    throw Error(ErrorKind::file,
                name + " is " + size_of(extent) +
                    "; a latitude-longitude map is twice as wide as high, from 4x2 to 16384x8192: "
                    "convert other projections first");
}

Environment::Environment(Extent extent, std::vector<float> rgb, const std::string& name)
    : extent_(extent), rgb_(std::move(rgb)) {
  check_size(extent, name);
  if (rgb_.size() != 3 * extent.pixels())
    throw Error(ErrorKind::file, name + " has " + std::to_string(rgb_.size()) +
                                     " values; three for each of " + size_of(extent) +
                                     " pixels are needed");
  for (size_t i = 0; i < rgb_.size(); ++i) {
    if (rgb_[i] >= 0 && rgb_[i] <= kMaxRadiance) continue;
    const size_t pixel = i / 3;
    throw Error(ErrorKind::file, name + " holds " + std::to_string(rgb_[i]) + " in column " +
                                     std::to_string(pixel % extent.width) + " of row " +
                                     std::to_string(pixel / extent.width) +
                                     "; radiance is a number from 0 to 1e9");
  }
}

Environment Environment::bounded(Extent extent, std::vector<float> rgb, size_t& changed,
                                 const std::string& name) {
  // Infinity stands for a value beyond the range of half floats.
  constexpr float kMaxHalf = 65504;
  changed = 0;
  const auto sound = [](float value) { return value >= 0 && value <= kMaxRadiance; };
  float max = 0;
  for (const float value : rgb)
    if (sound(value)) max = std::max(max, value);
  for (float& value : rgb) {
    if (sound(value)) continue;
    value = std::isinf(value) && value > 0 ? std::max(max, kMaxHalf)
                                           : (value > 0 ? kMaxRadiance : 0);  // NaN: 0
    ++changed;
  }
  return {extent, std::move(rgb), name};
}

void mirror_columns(std::vector<float>& rgb, Extent extent) {
  const size_t width = extent.width;
  for (size_t row = 0; row < extent.height; ++row) {
    float* const left = &rgb[3 * width * row];
    for (size_t x = 0; x < width / 2; ++x)
      std::swap_ranges(left + 3 * x, left + 3 * x + 3, left + 3 * (width - 1 - x));
  }
}

Environment Environment::uniform(std::array<float, 3> radiance) {
  constexpr Extent kExtent{16, 8};
  std::vector<float> rgb;
  for (uint64_t i = 0; i < kExtent.pixels(); ++i)
    rgb.insert(rgb.end(), radiance.begin(), radiance.end());
  return {kExtent, std::move(rgb)};
}

Environment Environment::studio() {
  constexpr Extent kExtent{256, 128};
  constexpr double kDegree = kPi / 180;
  constexpr double kCeiling = 0.36, kFloor = 0.13;          // radiance
  constexpr double kKey = 5.7, kFill = 1.42, kBack = 1.75;  // radiance of the boxes
  std::vector<float> rgb;
  rgb.reserve(3 * kExtent.pixels());
  for (uint32_t row = 0; row < kExtent.height; ++row)
    for (uint32_t column = 0; column < kExtent.width; ++column) {
      const double elevation = kPi * (0.5 - (row + 0.5) / kExtent.height);
      const double azimuth = 2 * kPi * ((column + 0.5) / kExtent.width - 0.5);
      const double up = 0.5 + 0.5 * std::sin(elevation);
      const double radiance =
          kFloor + (kCeiling - kFloor) * up +
          kKey * soft_box(azimuth, elevation, -42 * kDegree, 40 * kDegree, 0.30, 0.30) +
          kFill * soft_box(azimuth, elevation, 62 * kDegree, 18 * kDegree, 0.22, 0.42) +
          kBack * soft_box(azimuth, elevation, 160 * kDegree, 34 * kDegree, 0.55, 0.16);
      rgb.insert(rgb.end(), 3, static_cast<float>(radiance));
    }
  return {kExtent, std::move(rgb)};
}

std::array<double, 3> Environment::direction(double column, double row) const {
  const double azimuth = 2 * kPi * (column / extent_.width - 0.5);
  const double polar = kPi * row / extent_.height;
  return {std::sin(polar) * std::sin(azimuth), std::cos(polar),
          std::sin(polar) * std::cos(azimuth)};
}

double Environment::solid_angle(uint32_t row) const {
  const double top = kPi * row / extent_.height, bottom = kPi * (row + 1) / extent_.height;
  return 2 * kPi / extent_.width * (std::cos(top) - std::cos(bottom));
}

}  // namespace inverse
