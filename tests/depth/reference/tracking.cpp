// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracking.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

namespace inverse::reference {
namespace {

using Vector = Eigen::Vector3d;

constexpr double kJump = 0.03, kTurned = 0.05;

Vector vector(const Vec3& v) { return {v[0], v[1], v[2]}; }
Eigen::Quaterniond quaternion(const Camera& c) {
  return {c.rotation[3], c.rotation[0], c.rotation[1], c.rotation[2]};
}
double noise(double depth) { return 0.0012 + 0.0019 * (depth - 0.4) * (depth - 0.4); }

}  // namespace

Alignment align(const Sight& frame, const Sight& view, const AlignParams& params) {
  const Eigen::Quaterniond q = quaternion(frame.camera), v = quaternion(view.camera);
  const Vector place = vector(frame.camera.place), view_place = vector(view.camera.place);
  Eigen::Matrix<double, 6, 6> h = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> g = Eigen::Matrix<double, 6, 1>::Zero();
  double squares = 0, weights = 0, matched = 0, all = 0;
  const auto add = [&](const Vector& arm, const Vector& by_point, double r, double weight) {
    Eigen::Matrix<double, 6, 1> j;
    j << arm.cross(by_point), by_point;
    h += weight * j * j.transpose();
    g += weight * r * j;
  };
  const int width = view.camera.width, height = view.camera.height;
  for (int y = 0; y < frame.camera.height; ++y)
    for (int x = 0; x < frame.camera.width; ++x) {
      const Vec4& seen = frame.surface.at(x, y);
      if (!(seen[3] > 0)) continue;
      ++all;
      const Vector arm = q * (seen[3] * vector(frame.camera.ray(x, y)));
      const Vector p = v.conjugate() * (arm + place - view_place);
      if (p[2] <= 0) continue;
      const double u = view.camera.fx * p[0] / p[2] + view.camera.cx,
                   w = view.camera.fy * p[1] / p[2] + view.camera.cy;
      const int px = int(std::floor(u + 0.5)), py = int(std::floor(w + 0.5));
      if (px < 0 || py < 0 || px >= width || py >= height) continue;
      const Vec4& found = view.surface.at(px, py);
      if (!(found[3] > 0)) continue;
      const Vector apart = found[3] * vector(view.camera.ray(px, py)) - p;
      const Vector in_view(found[0], found[1], found[2]), normal = v * in_view;
      if (apart.norm() >= params.max_distance ||
          (q * Vector(seen[0], seen[1], seen[2])).dot(normal) <= params.min_cosine)
        continue;
      ++matched;
      const double r = in_view.dot(apart), weight = std::pow(noise(0.4) / noise(seen[3]), 2);
      add(arm, normal, r, weight);
      squares += weight * r * r;
      weights += weight;
      if (params.photometric <= 0) continue;
      const int x0 = std::clamp(int(std::floor(u)), 0, width - 2),
                y0 = std::clamp(int(std::floor(w)), 0, height - 2);
      const double fx = u - x0, fy = w - y0;
      const auto b = [&](int dx, int dy) {
        return view.brightness[view.surface.index(x0 + dx, y0 + dy)];
      };
      const auto goes_on = [&](int dx, int dy) {
        return std::abs(view.surface.at(x0 + dx, y0 + dy)[3] - found[3]) <= kJump * found[3];
      };
      if (!goes_on(0, 0) || !goes_on(1, 0) || !goes_on(0, 1) || !goes_on(1, 1)) continue;
      const double du = std::lerp(b(1, 0) - b(0, 0), b(1, 1) - b(0, 1), fy),
                   dw = std::lerp(b(0, 1) - b(0, 0), b(1, 1) - b(1, 0), fx);
      const double there =
          std::lerp(std::lerp(b(0, 0), b(1, 0), fx), std::lerp(b(0, 1), b(1, 1), fx), fy);
      const double sx = du * view.camera.fx / p[2], sy = dw * view.camera.fy / p[2];
      const double difference = frame.brightness[frame.surface.index(x, y)] - there;
      add(arm, v * Vector(sx, sy, -(sx * p[0] + sy * p[1]) / p[2]), difference,
          params.photometric * params.photometric * kTurned /
              std::max(std::abs(difference), kTurned));
    }
  h.diagonal().array() += params.damping * weights;
  const Eigen::Matrix<double, 6, 1> step = h.ldlt().solve(g);
  const Vector turn = step.head<3>();
  Eigen::Quaterniond moved = q;
  if (turn.norm() > 0) moved = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * q;
  Alignment result{frame.camera, std::sqrt(squares / weights), matched / all};
  result.camera.rotation = {moved.x(), moved.y(), moved.z(), moved.w()};
  for (size_t c = 0; c < 3; ++c) result.camera.place[c] += step[3 + Eigen::Index(c)];
  return result;
}

Agreement agreement(const Sight& frame, const Sight& view, double max_distance) {
  const int width = view.camera.width, height = view.camera.height;
  /// Ln brightness of the view where a pixel of the frame falls; empty: its surface is not there.
  const auto there = [&](int x, int y) -> std::optional<double> {
    const double depth = frame.surface.at(x, y)[3];
    if (!(depth > 0)) return {};
    const Vector p = quaternion(view.camera).conjugate() *
                     (quaternion(frame.camera) * (depth * vector(frame.camera.ray(x, y))) +
                      vector(frame.camera.place) - vector(view.camera.place));
    if (!(p[2] > 0)) return {};
    const double u = view.camera.fx * p[0] / p[2] + view.camera.cx,
                 w = view.camera.fy * p[1] / p[2] + view.camera.cy;
    if (!(u >= 0 && w >= 0 && u <= width - 1 && w <= height - 1)) return {};
    const int x0 = int(u), y0 = int(w);
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
      const int px = std::min(x0 + k % 2, width - 1), py = std::min(y0 + k / 2, height - 1);
      if (!(std::abs(view.surface.at(px, py)[3] - p[2]) < max_distance)) return {};
      sum += (k % 2 ? u - x0 : 1 - u + x0) * (k / 2 ? w - y0 : 1 - w + y0) *
             view.brightness[view.surface.index(px, py)];
    }
    return sum;
  };
  double both = 0, of_frame = 0, of_view = 0;
  Agreement result;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const bool down : {false, true}) {
        const int nx = x + (down ? 0 : 3), ny = y + (down ? 3 : 0);
        if (nx >= width || ny >= height) continue;
        const auto here = there(x, y), beside = there(nx, ny);
        const double depth = frame.surface.at(x, y)[3];
        if (!here || !beside || std::abs(frame.surface.at(nx, ny)[3] - depth) > kJump * depth)
          continue;
        const double a = *beside - *here, b = frame.brightness[frame.surface.index(nx, ny)] -
                                              frame.brightness[frame.surface.index(x, y)];
        both += a * b, of_frame += b * b, of_view += a * a;
        ++result.count;
      }
  result.correlation = both / std::sqrt(std::max(of_frame * of_view, 1e-20));
  result.frame = std::sqrt(of_frame / std::max(result.count, 1.0));
  result.view = std::sqrt(of_view / std::max(result.count, 1.0));
  return result;
}

Camera predict(const Camera& before, const Camera& last) {
  const Eigen::Quaterniond q = quaternion(last), moved = q * quaternion(before).conjugate() * q;
  const Vector place = vector(last.place) + (vector(last.place) - vector(before.place));
  Camera result = last;
  result.rotation = {moved.x(), moved.y(), moved.z(), moved.w()};
  for (size_t c = 0; c < 3; ++c) result.place[c] = place[Eigen::Index(c)];
  return result;
}

std::vector<double> smooth(int width, int height, const std::vector<double>& depth) {
  Plane shape(width, height);
  std::vector<double> result(depth.size(), 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double z = depth[shape.index(x, y)];
      if (!(z > 0 && z < 100)) continue;
      double sum = 0, total = 0;
      for (int v = y - 2; v <= y + 2; ++v)
        for (int u = x - 2; u <= x + 2; ++u) {
          const double other =
              depth[shape.index(std::clamp(u, 0, width - 1), std::clamp(v, 0, height - 1))];
          if (!(other > 0 && other < 100)) continue;
          const double far = (u - x) * (u - x) + (v - y) * (v - y),
                       step = (other - z) / (2.5 * noise(z));
          const double weight = std::exp(-0.5 * (far / (1.5 * 1.5) + step * step));
          sum += weight * other;
          total += weight;
        }
      result[shape.index(x, y)] = sum / total;
    }
  return result;
}

std::vector<double> log_brightness(const Plane& picture) {
  std::vector<double> result;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      double sum = 0;
      for (int v = y - 1; v <= y + 1; ++v)
        for (int u = x - 1; u <= x + 1; ++u) {
          const Vec4& p =
              picture.at(std::clamp(u, 0, picture.width - 1), std::clamp(v, 0, picture.height - 1));
          const int weight = (2 - std::abs(u - x)) * (2 - std::abs(v - y));
          sum += weight * std::log(std::max((p[0] + p[1] + p[2]) / 3, 1e-3));
        }
      result.push_back(sum / 16);
    }
  return result;
}

void halve(int width, int height, const std::vector<double>& depth,
           const std::vector<double>& brightness, std::vector<double>& half_depth,
           std::vector<double>& half_brightness) {
  half_depth.clear(), half_brightness.clear();
  for (int y = 0; y < height; y += 2)
    for (int x = 0; x < width; x += 2) {
      double nearest = 1e9, sum = 0, count = 0, light = 0;
      const auto for_four = [&](auto f) {
        for (int n = 0; n < 4; ++n)
          f(size_t(std::min(y + n / 2, height - 1)) * size_t(width) +
            size_t(std::min(x + n % 2, width - 1)));
      };
      for_four([&](size_t n) {
        if (depth[n] > 0) nearest = std::min(nearest, depth[n]);
        light += brightness[n] / 4;
      });
      for_four([&](size_t n) {
        if (depth[n] <= 0 || depth[n] >= nearest * (1 + kJump)) return;
        sum += depth[n];
        ++count;
      });
      half_depth.push_back(count > 0 ? sum / count : 0);
      half_brightness.push_back(light);
    }
}

}  // namespace inverse::reference
