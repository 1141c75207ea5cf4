// SPDX-License-Identifier: LGPL-2.1-or-later
#include "depth_map.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "kernels/image/pyramid.hpp"

namespace inverse {
namespace {

constexpr int kReach = 2;      // of the window of a normal
constexpr float kEdge = 0.1F;  // relative difference of depth that is an edge

struct Sum {
  float value = 0, weight = 0;
};

/// Gives what has no value the mean of what is around it, on the finest level that has one.
void fill_holes(std::vector<Sum>& fine, Extent extent) {
  if (extent.pixels() <= 1 ||
      std::all_of(fine.begin(), fine.end(), [](const Sum& sum) { return sum.weight > 0; }))
    return;
  const Extent half = half_of(extent);
  std::vector<Sum> coarse(half.pixels());
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const Sum& from = fine[size_t{y} * extent.width + x];
      Sum& to = coarse[size_t{y / 2} * half.width + x / 2];
      to.value += from.weight * from.value;
      to.weight += from.weight;
    }
  for (Sum& sum : coarse)
    if (sum.weight > 0) sum = {sum.value / sum.weight, 1};
  fill_holes(coarse, half);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      Sum& to = fine[size_t{y} * extent.width + x];
      if (!(to.weight > 0)) to = coarse[size_t{y / 2} * half.width + x / 2];
    }
}

/// Means, and sums of products about them.
struct Fit {
  double weight = 0, x = 0, y = 0, v = 0, xx = 0, xy = 0, yy = 0, xv = 0, yv = 0;
  void add(double dx, double dy, double value) {
    weight += 1, x += dx, y += dy, v += value;
    xx += dx * dx, xy += dx * dy, yy += dy * dy, xv += dx * value, yv += dy * value;
  }
  /// Slopes of the plane; 0 if the points are on a line.
  std::array<double, 2> slopes() const {
    const double a = xx - x * x / weight, b = xy - x * y / weight, c = yy - y * y / weight;
    const double p = xv - x * v / weight, q = yv - y * v / weight, det = a * c - b * b;
    if (!(det > 1e-9 * (1 + a * c))) return {};
    return {(c * p - b * q) / det, (a * q - b * p) / det};
  }
};

}  // namespace

DepthMap::DepthMap(const PngPixels& png, const std::string& path) : extent_(png.extent) {
  codes_.resize(extent_.pixels());
  const float unit = png.is_16_bits ? 1 : 257;
  for (size_t i = 0; i < codes_.size(); ++i)
    codes_[i] = static_cast<float>(png.codes[4 * i]) / unit;
  if (std::none_of(codes_.begin(), codes_.end(), [](float code) { return code > 0; }))
    throw Error(ErrorKind::file, path +
                                     ": it is black, so that nothing in it has depth; a depth "
                                     "picture is a gray PNG, with 0 where depth is unknown");
  *this = DepthMap(extent_, std::move(codes_));
}

DepthMap::DepthMap(Extent extent, std::vector<float> codes)
    : extent_(extent), codes_(std::move(codes)) {
  std::vector<float> known;
  std::vector<Sum> sums;
  for (const float code : codes_) {
    sums.push_back({code, code > 0 ? 1.F : 0.F});
    if (code > 0) known.push_back(code);
  }
  if (known.empty() || codes_.size() != extent.pixels())
    throw Error(ErrorKind::internal, "a depth map without depth, or of another size");
  std::nth_element(known.begin(), known.begin() + static_cast<long>(known.size() / 2), known.end());
  median_ = known[known.size() / 2];
  fill_holes(sums, extent);
  for (size_t i = 0; i < codes_.size(); ++i) codes_[i] = sums[i].value;
}

std::vector<SurfacePixel> DepthMap::own_surface(Extent frame, float focal_length,
                                                float units) const {
  const int width = static_cast<int>(extent_.width), height = static_cast<int>(extent_.height);
  const double across = static_cast<double>(frame.width) / width,
               down = static_cast<double>(frame.height) / height;
  std::vector<SurfacePixel> surface(extent_.pixels());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float* row = &codes_[size_t{static_cast<uint32_t>(y)} * extent_.width];
      const double own = static_cast<double>(row[x]);
      Fit fit;
      for (int j = std::max(y - kReach, 0); j <= std::min(y + kReach, height - 1); ++j)
        for (int i = std::max(x - kReach, 0); i <= std::min(x + kReach, width - 1); ++i) {
          const double code = static_cast<double>(
              codes_[size_t{static_cast<uint32_t>(j)} * extent_.width + static_cast<uint32_t>(i)]);
          if (std::abs(code - own) <= static_cast<double>(kEdge) * own)
            fit.add((i - x) * across, (j - y) * down, own / code);
        }
      // own / Z of a plane is linear in x and y: slopes[0] x + slopes[1] y + c.
      const auto slopes = fit.slopes();
      const double f = static_cast<double>(focal_length);
      const double c = 1 - slopes[0] * ((x + .5) * across - .5 * frame.width) -
                       slopes[1] * ((y + .5) * down - .5 * frame.height);
      const double nx = -slopes[0] * f, ny = -slopes[1] * f;
      const double length = std::sqrt(nx * nx + ny * ny + c * c);
      surface[static_cast<size_t>(row - codes_.data()) + static_cast<size_t>(x)] = {
          static_cast<float>(nx / length), static_cast<float>(ny / length),
          static_cast<float>(c / length), static_cast<float>(own) / units};
    }
  return surface;
}

std::vector<SurfacePixel> DepthMap::surface(Extent frame, float focal_length, float units) const {
  std::vector<SurfacePixel> own = own_surface(frame, focal_length, units);
  if (frame == extent_) return own;
  std::vector<SurfacePixel> surface(frame.pixels());
  const auto axis = [](uint32_t at, uint32_t size, uint32_t own_size) {
    const float place =
        (static_cast<float>(at) + .5F) * static_cast<float>(own_size) / static_cast<float>(size) -
        .5F;
    return std::clamp(place, 0.F, static_cast<float>(own_size - 1));
  };
  for (uint32_t y = 0; y < frame.height; ++y)
    for (uint32_t x = 0; x < frame.width; ++x) {
      const float column = axis(x, frame.width, extent_.width);
      const float row = axis(y, frame.height, extent_.height);
      const auto left = static_cast<uint32_t>(column), top = static_cast<uint32_t>(row);
      const auto at = [&](uint32_t i, uint32_t j) -> const SurfacePixel& {
        return own[size_t{std::min(j, extent_.height - 1)} * extent_.width +
                   std::min(i, extent_.width - 1)];
      };
      const float right = column - static_cast<float>(left), below = row - static_cast<float>(top);
      const SurfacePixel& near = at(left + (right >= .5F), top + (below >= .5F));
      SurfacePixel sum{};
      float weights = 0;
      for (uint32_t k = 0; k < 4; ++k) {
        const SurfacePixel& pixel = at(left + k % 2, top + k / 2);
        if (std::abs(pixel[3] - near[3]) > kEdge * near[3]) continue;
        const float weight = (k % 2 ? right : 1 - right) * (k / 2 ? below : 1 - below);
        weights += weight;
        for (size_t c = 0; c < 4; ++c) sum[c] += weight * pixel[c];
      }
      const float length = std::hypot(sum[0], sum[1], sum[2]);
      surface[size_t{y} * frame.width + x] =
          length > 0
              ? SurfacePixel{sum[0] / length, sum[1] / length, sum[2] / length, sum[3] / weights}
              : near;
    }
  return surface;
}

}  // namespace inverse
