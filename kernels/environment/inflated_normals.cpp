// SPDX-License-Identifier: LGPL-2.1-or-later
#include "inflated_normals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace inverse {
namespace {

constexpr uint32_t kCoarsest = 8;  // points along a side
constexpr int kSweeps = 16;        // a level: 1 degree from where more would lead

/// One resolution of ∇²u = −4. A neighbor outside of the mask has −u, so that u is 0 midway to it;
/// one outside of the window has u, so that the surface continues.
class Level {
 public:
  Level(std::vector<uint8_t> mask, uint32_t side, const GridWindow& window, float spacing)
      : mask_(std::move(mask)), side_(side), window_(window), source_(4 * spacing * spacing) {
    for (uint32_t row = 0; row < side_; ++row)
      for (uint32_t column = 0; column < side_; ++column)
        if (!window_has(column, row)) mask_[index(column, row)] = 0;
    u_.assign(mask_.size(), 0.0F);
  }

  /// The same object on half as many points per side: those with half or more of their points in
  /// the mask.
  Level coarser(float spacing) const {
    const uint32_t half = side_ / 2;
    std::vector<uint8_t> mask(size_t{half} * half);
    for (uint32_t row = 0; row < half; ++row)
      for (uint32_t column = 0; column < half; ++column) {
        const auto at = [&](uint32_t x, uint32_t y) {
          return int{mask_[index(2 * column + x, 2 * row + y)]};
        };
        mask[size_t{row} * half + column] = at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1) >= 2;
      }
    return {std::move(mask),
            half,
            {window_.left / 2, window_.top / 2, (window_.right + 1) / 2, (window_.bottom + 1) / 2},
            spacing};
  }

  /// Interpolates between the nearest four points, with the borders of `solve`.
  void start_from(const Level& coarse) {
    for (uint32_t row = 0; row < side_; ++row)
      for (uint32_t column = 0; column < side_; ++column) {
        if (!mask_[index(column, row)]) continue;
        const uint32_t x = std::min(column / 2, coarse.side_ - 1);
        const uint32_t y = std::min(row / 2, coarse.side_ - 1);
        const uint32_t far_x = column % 2 ? x + 1 : x - 1, far_y = row % 2 ? y + 1 : y - 1;
        const auto u = [&](uint32_t c, uint32_t r) {
          return coarse.window_has(c, r) ? coarse.u_[coarse.index(c, r)]
                                         : coarse.u_[coarse.index(x, y)];
        };
        u_[index(column, row)] =
            (9 * u(x, y) + 3 * u(far_x, y) + 3 * u(x, far_y) + u(far_x, far_y)) / 16;
      }
  }

  /// Successive over-relaxation with the optimal factor for a square of the object's size.
  void solve() {
    struct Point {
      uint32_t at;
      std::array<uint32_t, 4> neighbors;  // itself if u is not an unknown
      float inverse;                      // of what u is multiplied by
    };
    std::vector<Point> points;
    bool outlined = false;
    uint32_t left = side_, right = 0, top = side_, bottom = 0;
    for (uint32_t row = 0; row < side_; ++row)
      for (uint32_t column = 0; column < side_; ++column) {
        if (!mask_[index(column, row)]) continue;
        left = std::min(left, column), right = std::max(right, column);
        top = std::min(top, row), bottom = std::max(bottom, row);
        Point point{index(column, row), {}, 0};
        float factor = 0;
        for (int n = 0; n < 4; ++n) {
          const auto [x, y] = neighbor(column, row, n);
          const bool inside = window_has(x, y) && mask_[index(x, y)];
          point.neighbors[n] = inside ? index(x, y) : kNone;
          factor += inside ? 1.0F : window_has(x, y) ? 2.0F : 0.0F;
          outlined |= !inside && window_has(x, y);
        }
        point.inverse = factor > 0 ? 1 / factor : 0;
        points.push_back(point);
      }
    if (!outlined) return std::fill(u_.begin(), u_.end(), 0.0F);  // faces us
    const double extent = 1 + std::max(right - left, bottom - top);
    const auto relaxation = static_cast<float>(2 / (1 + std::sin(std::numbers::pi / (extent + 1))));
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      float largest = 0, change = 0;
      for (const Point& point : points) {
        float sum = source_;
        for (const uint32_t neighbor : point.neighbors)
          if (neighbor != kNone) sum += u_[neighbor];
        const float step = relaxation * (sum * point.inverse - u_[point.at]);
        u_[point.at] += step;
        change = std::max(change, std::fabs(step));
        largest = std::max(largest, u_[point.at]);
      }
      if (change < 1e-3F * largest) break;
    }
  }

  std::vector<Normal> normals() const {
    std::vector<Normal> result(mask_.size(), Normal{});
    for (uint32_t row = 0; row < side_; ++row)
      for (uint32_t column = 0; column < side_; ++column) {
        const uint32_t at = index(column, row);
        if (!mask_[at]) continue;
        std::array<float, 4> u{};
        for (int n = 0; n < 4; ++n) {
          const auto [x, y] = neighbor(column, row, n);
          u[n] = !window_has(x, y) ? u_[at] : mask_[index(x, y)] ? u_[index(x, y)] : -u_[at];
        }
        // Gradient of the height √u, times 2 √u.
        const float x = (u[0] - u[1]) / 2, y = (u[3] - u[2]) / 2;
        const float z = 2 * std::sqrt(std::max(u_[at], 0.0F));
        const float length = std::sqrt(x * x + y * y + z * z);
        if (length > 0 && z > 0)
          result[at] = {x / length, y / length, z / length};
        else
          result[at] = {0, 0, 1};
      }
    return result;
  }

 private:
  static constexpr uint32_t kNone = ~0U;
  uint32_t index(uint32_t column, uint32_t row) const { return row * side_ + column; }
  bool window_has(uint32_t column, uint32_t row) const {
    return column >= window_.left && column < window_.right && row >= window_.top &&
           row < window_.bottom && column < side_ && row < side_;
  }
  /// Left, right, up, down; ~0 wraps to a position outside of every window.
  static std::pair<uint32_t, uint32_t> neighbor(uint32_t column, uint32_t row, int n) {
    constexpr int kStep[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    return {column + static_cast<uint32_t>(kStep[n][0]), row + static_cast<uint32_t>(kStep[n][1])};
  }

  std::vector<uint8_t> mask_;
  uint32_t side_;
  GridWindow window_;
  float source_;
  std::vector<float> u_;
};

/// From coarse to fine, each initialized from the coarser one.
Level solved(Level level, uint32_t side, float spacing) {
  if (side % 2 == 0 && side / 2 >= kCoarsest)
    level.start_from(solved(level.coarser(2 * spacing), side / 2, 2 * spacing));
  level.solve();
  return level;
}

}  // namespace

std::vector<Normal> inflated_normals(std::span<const uint8_t> mask, uint32_t side,
                                     const GridWindow& window) {
  std::vector<uint8_t> points(size_t{side} * side, 0);
  for (size_t i = 0; i < std::min(points.size(), mask.size()); ++i) points[i] = mask[i] != 0;
  return solved(Level(std::move(points), side, window, 1), side, 1).normals();
}

}  // namespace inverse
