// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

#include "common/error.hpp"

namespace inverse {
namespace {

using Vec3 = Mesh::Vec3;
using Real3 = std::array<double, 3>;

bool finite(const Vec3& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}
double length(const Real3& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/// Twice the triangle's area along its normal.
Real3 area_normal(const Mesh& mesh, size_t triangle) {
  const Vec3& a = mesh.positions[mesh.indices[3 * triangle]];
  const Vec3& b = mesh.positions[mesh.indices[3 * triangle + 1]];
  const Vec3& c = mesh.positions[mesh.indices[3 * triangle + 2]];
  Real3 u, v;
  for (size_t i = 0; i < 3; ++i) {
    u[i] = double{b[i]} - a[i];
    v[i] = double{c[i]} - a[i];
  }
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

void drop_bad_triangles(Mesh& mesh) {
  std::vector<uint32_t> kept;
  kept.reserve(mesh.indices.size());
  for (size_t t = 0; t < mesh.triangles(); ++t) {
    const uint32_t* corner = &mesh.indices[3 * t];
    bool good = true;
    for (size_t i = 0; i < 3; ++i)
      good = good && corner[i] < mesh.positions.size() && finite(mesh.positions[corner[i]]);
    if (good && length(area_normal(mesh, t)) > 0) kept.insert(kept.end(), corner, corner + 3);
  }
  mesh.indices = std::move(kept);
}

/// Removes corners that no triangle uses.
void drop_loose_corners(Mesh& mesh) {
  constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
  std::vector<uint32_t> place(mesh.positions.size(), kNone);
  uint32_t count = 0;
  for (uint32_t& index : mesh.indices) {
    if (place[index] == kNone) {
      place[index] = count++;
    }
    index = place[index];
  }
  std::vector<Vec3> positions(count), normals(count);
  for (size_t i = 0; i < place.size(); ++i)
    if (place[i] != kNone) {
      positions[place[i]] = mesh.positions[i];
      normals[place[i]] = mesh.normals[i];
    }
  mesh.positions = std::move(positions);
  mesh.normals = std::move(normals);
}

void center_and_scale(Mesh& mesh) {
  constexpr double kFar = std::numeric_limits<double>::max();
  Real3 low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  for (const Vec3& p : mesh.positions)
    for (size_t i = 0; i < 3; ++i) {
      low[i] = std::min<double>(low[i], p[i]);
      high[i] = std::max<double>(high[i], p[i]);
    }
  double reach = 0;
  const auto centered = [&](const Vec3& p) {
    return Real3{p[0] - (low[0] + high[0]) / 2, p[1] - (low[1] + high[1]) / 2,
                 p[2] - (low[2] + high[2]) / 2};
  };
  for (const Vec3& p : mesh.positions) reach = std::max(reach, length(centered(p)));
  for (Vec3& p : mesh.positions) {
    const Real3 moved = centered(p);
    for (size_t i = 0; i < 3; ++i) p[i] = static_cast<float>(moved[i] / reach);
  }
}

void complete_normals(Mesh& mesh) {
  std::vector<Real3> sums(mesh.positions.size(), Real3{});
  for (size_t t = 0; t < mesh.triangles(); ++t) {
    const Real3 normal = area_normal(mesh, t);
    for (size_t corner = 0; corner < 3; ++corner)
      for (size_t i = 0; i < 3; ++i) sums[mesh.indices[3 * t + corner]][i] += normal[i];
  }
  for (size_t i = 0; i < mesh.normals.size(); ++i) {
    Vec3& normal = mesh.normals[i];
    Real3 n{normal[0], normal[1], normal[2]};
    if (!finite(normal) || !(length(n) > 0)) n = sums[i];
    const double size = length(n);
    if (!(size > 0)) n = {0, 0, 1};  // triangles whose normals cancel: any is as good
    for (size_t c = 0; c < 3; ++c) normal[c] = static_cast<float>(n[c] / (size > 0 ? size : 1));
  }
}

/// Interleaves ten bits of each coordinate (Morton code).
uint32_t morton(const Real3& p) {
  uint32_t code = 0;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const auto v = static_cast<uint32_t>(std::clamp((p[axis] + 1) * 512, 0.0, 1023.0));
    for (uint32_t bit = 0; bit < 10; ++bit) code |= (v >> bit & 1U) << (3 * bit + axis);
  }
  return code;
}

void sort_by_place(Mesh& mesh) {
  std::vector<std::pair<uint32_t, uint32_t>> order(mesh.triangles());
  for (uint32_t t = 0; t < order.size(); ++t) {
    Real3 middle{};
    for (size_t corner = 0; corner < 3; ++corner)
      for (size_t i = 0; i < 3; ++i)
        middle[i] += double{mesh.positions[mesh.indices[3 * size_t{t} + corner]][i]} / 3;
    order[t] = {morton(middle), t};
  }
  std::sort(order.begin(), order.end());
  std::vector<uint32_t> sorted;
  sorted.reserve(mesh.indices.size());
  for (const auto& [code, t] : order)
    sorted.insert(sorted.end(), &mesh.indices[3 * size_t{t}], &mesh.indices[3 * size_t{t}] + 3);
  mesh.indices = std::move(sorted);
}

}  // namespace

void Mesh::prepare(const char* name) {
  const std::string what = std::string("mesh ") + name;
  if (triangles() > kMaxTriangles)
    throw Error(ErrorKind::file, what + " has " + std::to_string(triangles()) +
                                     " triangles; at most " + std::to_string(kMaxTriangles) +
                                     " can be drawn: simplify it, with Blender's Decimate for "
                                     "example");
  normals.resize(positions.size(), Vec3{});
  drop_bad_triangles(*this);
  if (indices.empty())
    throw Error(ErrorKind::file, what + " has no triangle with an area; nothing can be drawn");
  drop_loose_corners(*this);
  center_and_scale(*this);
  // Collapsed triangles: corners that coincide relative to the size of the mesh.
  drop_bad_triangles(*this);
  if (indices.empty())
    throw Error(ErrorKind::file, what + " has no triangle with an area; nothing can be drawn");
  complete_normals(*this);
  sort_by_place(*this);
}

Mesh Mesh::sphere() {
  constexpr uint32_t kRows = 48, kColumns = 96;
  constexpr double kPi = std::numbers::pi;
  Mesh mesh;
  for (uint32_t row = 0; row <= kRows; ++row)
    for (uint32_t column = 0; column <= kColumns; ++column) {
      const double polar = kPi * row / kRows, azimuth = 2 * kPi * column / kColumns;
      mesh.positions.push_back({static_cast<float>(std::sin(polar) * std::sin(azimuth)),
                                static_cast<float>(std::cos(polar)),
                                static_cast<float>(std::sin(polar) * std::cos(azimuth))});
    }
  mesh.normals = mesh.positions;
  for (uint32_t row = 0; row < kRows; ++row)
    for (uint32_t column = 0; column < kColumns; ++column) {
      const uint32_t a = row * (kColumns + 1) + column, b = a + kColumns + 1;
      mesh.indices.insert(mesh.indices.end(), {a, b, b + 1, a, b + 1, a + 1});
    }
  mesh.prepare("sphere");
  return mesh;
}

}  // namespace inverse
