// SPDX-License-Identifier: LGPL-2.1-or-later
#include "volume.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

constexpr int kSide = 8;
constexpr size_t kVoxels = 512;

Vec3 plus(const Vec3& a, const Vec3& b, double scale = 1) {
  return {a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2]};
}
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vec3 rotated(const std::array<double, 4>& q, const Vec3& v) {
  const Vec3 axis{q[0], q[1], q[2]};
  Vec3 t = cross(axis, v);
  for (double& x : t) x *= 2;
  return plus(plus(v, t, q[3]), cross(axis, t));
}
Cell cell_of(const Vec3& place, double side) {
  return {int(std::floor(place[0] / side)), int(std::floor(place[1] / side)),
          int(std::floor(place[2] / side))};
}
Cell block_of(const Cell& voxel) {
  const auto down = [](int v) { return v >= 0 ? v / kSide : -((-v + kSide - 1) / kSide); };
  return {down(voxel[0]), down(voxel[1]), down(voxel[2])};
}
size_t place_in(const Cell& voxel, const Cell& block) {
  size_t place = 0;
  for (size_t c = 3; c-- > 0;) place = kSide * place + size_t(voxel[c] - kSide * block[c]);
  return place;
}

}  // namespace

Vec3 Camera::turned(const Vec3& v) const { return rotated(rotation, v); }
Vec3 Camera::to_world(const Vec3& v) const { return plus(turned(v), place); }
Vec3 Camera::to_camera(const Vec3& v) const {
  return rotated({-rotation[0], -rotation[1], -rotation[2], rotation[3]}, plus(v, place, -1));
}

void Volume::allocate(const Camera& camera, const Plane& surface) {
  const double side = kSide * voxel;
  for (int y = 0; y < camera.height; y += 2)
    for (int x = 0; x < camera.width; x += 2) {
      const double depth = surface.at(x, y)[3];
      if (!(depth > 0 && depth <= max_depth)) continue;
      const Vec3 ray = camera.ray(x, y);
      const double reach = truncation / std::sqrt(dot(ray, ray));
      const int steps = int(std::ceil(4 * truncation / side));
      for (int i = 0; i <= steps; ++i) {
        const double z = depth + reach * (2.0 * i / steps - 1);
        if (z > 0) blocks.try_emplace(cell_of(camera.to_world(plus({}, ray, z)), side), kVoxels);
      }
    }
}

void Volume::integrate(const Camera& camera, const Plane& surface, const Plane& layers) {
  constexpr double kMinCosine = 0.15;
  for (auto& [block, voxels] : blocks)
    for (size_t n = 0; n < voxels.size(); ++n) {
      const size_t in_block[] = {n % kSide, n / kSide % kSide, n / kSide / kSide};
      Vec3 center;
      for (size_t c = 0; c < 3; ++c)
        center[c] = (kSide * block[c] + int(in_block[c]) + 0.5) * voxel;
      const Vec3 at = camera.to_camera(center);
      if (at[2] <= 0) continue;
      const int x = int(std::floor(camera.fx * at[0] / at[2] + camera.cx + 0.5)),
                y = int(std::floor(camera.fy * at[1] / at[2] + camera.cy + 0.5));
      if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) continue;
      const size_t pixel = surface.index(x, y);
      const auto& seen = surface.data[pixel];
      const double depth = seen[3];
      if (!(depth > 0 && depth <= max_depth)) continue;
      const Vec3 normal{seen[0], seen[1], seen[2]};
      const double cosine = -dot(normal, at) / std::sqrt(dot(at, at));
      const double distance =
          (depth - at[2]) * (cosine > kMinCosine ? -dot(normal, at) / at[2] : 1) / truncation;
      if (distance < -1) continue;
      const double confidence =
          std::clamp(cosine, kMinCosine, 1.0) * std::clamp(1 / (depth * depth), 0.125, 1.0);
      const double weight = std::max(std::floor(8 * confidence + 0.5), 1.0);
      Voxel& v = voxels[n];
      v.distance = (v.distance * v.weight + std::min(distance, 1.0) * weight) / (v.weight + weight);
      v.weight = std::min(v.weight + weight, 255.0);
      if (cosine <= kMinCosine || std::abs(distance) >= 0.35) continue;
      const double before = v.sure * memory;
      for (size_t c = 0; c < 3; ++c) {
        const double now = std::log(std::max(layers.data[pixel][c], 1e-3));
        v.color[c] +=
            before > 0 ? (now - v.color[c]) * confidence / (before + confidence) : now - v.color[c];
      }
      v.sure = std::min((before + confidence) / memory, 1.0);
    }
}

const Voxel* Volume::at(const Cell& cell) const {
  const Cell block = block_of(cell);
  const auto found = blocks.find(block);
  return found == blocks.end() ? nullptr : &found->second[place_in(cell, block)];
}

bool Volume::distance_at(const Vec3& place, double& distance) const {
  Cell low;
  Vec3 share;
  for (size_t c = 0; c < 3; ++c) {
    const double at = place[c] / voxel - 0.5;
    low[c] = int(std::floor(at));
    share[c] = at - low[c];
  }
  double sum = 0, total = 0;
  for (int n = 0; n < 8; ++n) {
    const Cell cell{low[0] + (n & 1), low[1] + (n >> 1 & 1), low[2] + (n >> 2)};
    const Voxel* v = at(cell);
    if (!v || v->weight <= 0) continue;
    double weight = 1;
    for (size_t c = 0; c < 3; ++c) weight *= (n >> c & 1) ? share[c] : 1 - share[c];
    sum += weight * v->distance;
    total += weight;
  }
  distance = sum / total;
  return total >= 0.33;
}

double Volume::march(const Camera& camera, int x, int y, double from, double to) const {
  const Vec3 ray = camera.ray(x, y);
  const double step = 0.1 * voxel / std::sqrt(dot(ray, ray));
  double before = 0;
  for (int n = 0; from + n * step < to; ++n) {
    const double z = from + n * step;
    double now = 0;
    if (!distance_at(camera.to_world(plus({}, ray, z)), now)) {
      before = 0;
      continue;
    }
    if (before > 0 && now <= 0) return z - step * now / (now - before);
    before = now;
  }
  return 0;
}

Voxel merged(const Voxel& a, const Voxel& b) {
  const double weight = a.weight + b.weight, sure = a.sure + b.sure;
  Voxel both = a;
  if (weight > 0) both.distance = (a.distance * a.weight + b.distance * b.weight) / weight;
  for (size_t c = 0; c < 3; ++c)
    if (sure > 0) both.color[c] = (a.color[c] * a.sure + b.color[c] * b.sure) / sure;
  both.weight = std::min(weight, 255.0);
  both.sure = std::min(sure, 1.0);
  return both;
}

bool elsewhere(const Camera& a, const Camera& b, double max_turn, double max_shift) {
  double along = 0, square = 0;
  for (size_t c = 0; c < 4; ++c) along += a.rotation[c] * b.rotation[c];
  for (size_t c = 0; c < 3; ++c) square += (a.place[c] - b.place[c]) * (a.place[c] - b.place[c]);
  return 2 * std::acos(std::min(1.0, std::abs(along))) > max_turn || std::sqrt(square) > max_shift;
}

Plane normals(const Camera& camera, const std::vector<double>& depth) {
  constexpr double kJump = 0.03;
  Plane result(camera.width, camera.height);
  const auto point = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) return Vec3{};
    return plus({}, camera.ray(x, y), depth[result.index(x, y)]);
  };
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Vec3 at = point(x, y);
      const auto difference = [&](int dx, int dy) {
        const Vec3 low = point(x - dx, y - dy), high = point(x + dx, y + dy);
        const auto near = [&](const Vec3& p) {
          return p[2] > 0 && std::abs(p[2] - at[2]) < kJump * at[2];
        };
        return plus(near(high) ? high : at, near(low) ? low : at, -1);
      };
      const Vec3 normal = cross(difference(0, 1), difference(1, 0));
      const double length = std::sqrt(dot(normal, normal));
      auto& out = result.at(x, y);
      out = {0, 0, 0, at[2]};
      if (at[2] > 0 && length > 0)
        for (size_t c = 0; c < 3; ++c) out[c] = normal[c] / length;
    }
  return result;
}

}  // namespace inverse::reference
