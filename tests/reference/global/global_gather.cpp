// SPDX-License-Identifier: LGPL-2.1-or-later
#include "global_gather.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace inverse::reference::global {
namespace {

constexpr double kMinNumber = 0.02;  // of emitters around a point

/// Zero-padded Gaussian along rows, then columns; every value of T is a sum of doubles.
template <class T>
std::vector<T> blur(const std::vector<T>& in, int width, int height, double sigma) {
  const int reach = int(std::ceil(3 * sigma));
  std::vector<double> tap;
  double sum = 0;
  for (int d = -reach; d <= reach; ++d)
    sum += tap.emplace_back(std::exp(-0.5 * d * d / (sigma * sigma)));
  std::vector<T> rows(in.size()), out(in.size());
  const auto at = [&](int x, int y) {
    return std::size_t(y) * std::size_t(width) + std::size_t(x);
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int u = std::max(0, x - reach); u <= std::min(width - 1, x + reach); ++u)
        for (std::size_t c = 0; c < in[0].size(); ++c)
          rows[at(x, y)][c] += tap[std::size_t(u - x + reach)] / sum * in[at(u, y)][c];
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int v = std::max(0, y - reach); v <= std::min(height - 1, y + reach); ++v)
        for (std::size_t c = 0; c < in[0].size(); ++c)
          out[at(x, y)][c] += tap[std::size_t(v - y + reach)] / sum * rows[at(x, v)][c];
  return out;
}

}  // namespace

Gather::Gather(const Grid& grid, const std::vector<int>& labels, int count,
               const GatherParams& params)
    : params_(params), width_((grid.width + 1) / 2), height_((grid.height + 1) / 2) {
  std::vector<double> points(size(), 0.0);
  std::vector<std::vector<Vec4>> emitted(std::size_t(count), std::vector<Vec4>(size(), Vec4{}));
  mean_.assign(std::size_t(count), Vec3{});
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(grid.width) + std::size_t(x);
      const std::size_t j = std::size_t(y / 2) * std::size_t(width_) + std::size_t(x / 2);
      const auto k = std::size_t(labels[i]);
      for (std::size_t c = 0; c < 3; ++c) {
        emitted[k][j][c] += grid.color[i][c];
        mean_[k][c] += grid.color[i][c] / double(grid.size());
      }
      emitted[k][j][3] += 1;
      points[j] += 1;
    }
  std::vector<Vec3> all(size(), Vec3{});
  number_.assign(size(), 0.0);
  for (auto& label : emitted) {
    for (std::size_t j = 0; j < size(); ++j)
      for (double& v : label[j]) v /= points[j];
    label = blur(label, width_, height_, params.reach * width_);
    for (std::size_t j = 0; j < size(); ++j) {
      for (std::size_t c = 0; c < 3; ++c) all[j][c] += label[j][c];
      number_[j] += label[j][3];
    }
  }
  emitted_ = std::move(emitted);
  own_ = count > 1 ? params.own : 0;
  Vec3 frame{};
  for (const Vec3& part : mean_)
    for (std::size_t c = 0; c < 3; ++c) frame[c] += part[c];
  for (std::size_t k = 0; k < std::size_t(count); ++k) {
    received_.emplace_back(size());
    for (std::size_t j = 0; j < size(); ++j)
      for (std::size_t c = 0; c < 3; ++c)
        received_[k][j][c] =
            params.near_share * (all[j][c] - own_ * emitted_[k][j][c]) / emitters(int(k), j) +
            (1 - params.near_share) * frame[c];
  }
}

double Gather::emitters(int label, std::size_t j) const {
  return number_[j] - own_ * emitted_[std::size_t(label)][j][3] + kMinNumber;
}

template <class Value>
Vec3 Gather::blend(const Value& value, int x, int y, int factor) const {
  const Between u = between(x, factor, width_), v = between(y, factor, height_);
  Vec3 out{};
  for (const auto& [row, wy] : {std::pair{v.low, 1 - v.share}, std::pair{v.high, v.share}})
    for (const auto& [column, wx] : {std::pair{u.low, 1 - u.share}, std::pair{u.high, u.share}}) {
      const Vec3 at = value(row * std::size_t(width_) + column);
      for (std::size_t c = 0; c < 3; ++c) out[c] += wy * wx * at[c];
    }
  return out;
}

Vec3 Gather::received(int label, int x, int y, int factor) const {
  const auto& plane = received_[std::size_t(label)];
  return blend([&](std::size_t j) { return plane[j]; }, x, y, factor);
}

Vec3 Gather::received_from(int k, int label, int x, int y, int factor) const {
  const auto& from = emitted_[std::size_t(k)];
  const Vec3& far = mean_[std::size_t(k)];
  const double seen = params_.near_share * (k == label ? 1 - own_ : 1.0);
  return blend(
      [&](std::size_t j) {
        Vec3 out;
        for (std::size_t c = 0; c < 3; ++c)
          out[c] = seen * from[j][c] / emitters(label, j) + (1 - params_.near_share) * far[c];
        return out;
      },
      x, y, factor);
}

}  // namespace inverse::reference::global
