// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mesh.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <unordered_map>

namespace inverse {
namespace {

static_assert(std::endian::native == std::endian::little, "the PLY file says so");

using Cell = std::array<int, 3>;

constexpr int kSide = 8;       // of a block
constexpr float kMaxStep = 1;  // truncations from voxel to voxel; more is no surface
constexpr float kLowest = -7, kHighest = 1.5F;  // ln reflectance
constexpr uint32_t kNone = 0xffffffff;

class Mesher {
 public:
  explicit Mesher(const VolumeData& data) : data_(data) {
    for (uint32_t i = 0; i < data.keys.size(); ++i) blocks_.emplace(data.keys[i], i);
    vertex_of_.resize(data.voxels.size(), kNone);
  }
  SceneMesh make() {
    for (uint32_t b = 0; b < data_.keys.size(); ++b)
      each_voxel(b, [&](const Cell& cell, size_t at) {
        if (const auto vertex = vertex_in(cell)) {
          vertex_of_[at] = static_cast<uint32_t>(mesh_.vertices.size());
          mesh_.vertices.push_back(*vertex);
        }
      });
    for (uint32_t b = 0; b < data_.keys.size(); ++b)
      each_voxel(b, [&](const Cell& cell, size_t) { connect(cell); });
    return std::move(mesh_);
  }

 private:
  template <typename Function>
  void each_voxel(uint32_t block, Function function) const {
    const Cell first = VolumeData::block_of(data_.keys[block]);
    for (int n = 0; n < static_cast<int>(VolumeData::kBlockVoxels); ++n)
      function({kSide * first[0] + n % kSide, kSide * first[1] + n / kSide % kSide,
                kSide * first[2] + n / kSide / kSide},
               block * VolumeData::kBlockVoxels + static_cast<size_t>(n));
  }
  /// The place of a voxel in the data; none if it has no block.
  std::optional<size_t> find(const Cell& cell) const {
    const auto found = blocks_.find(VolumeData::key_of({cell[0] >> 3, cell[1] >> 3, cell[2] >> 3}));
    if (found == blocks_.end()) return {};
    return found->second * VolumeData::kBlockVoxels +
           static_cast<size_t>((cell[0] & 7) | (cell[1] & 7) << 3 | (cell[2] & 7) << 6);
  }
  /// The distance at a voxel that was seen.
  std::optional<float> distance(const Cell& cell) const {
    const auto at = find(cell);
    if (!at || VolumeData::weight_of(data_.voxels[*at]) == 0) return {};
    return VolumeData::distance_of(data_.voxels[*at]);
  }
  static Cell corner(const Cell& cell, size_t n) {
    return {cell[0] + static_cast<int>(n & 1), cell[1] + static_cast<int>(n >> 1 & 1),
            cell[2] + static_cast<int>(n >> 2)};
  }
  static bool crosses(float a, float b) { return (a > 0) != (b > 0) && std::abs(a - b) < kMaxStep; }

  /// The vertex of the cell whose first corner is this voxel's center.
  std::optional<SceneMesh::Vertex> vertex_in(const Cell& cell) const {
    std::array<float, 8> d{};
    uint32_t inside = 0;
    for (size_t n = 0; n < d.size(); ++n) {
      const auto here = distance(corner(cell, n));
      if (!here) return {};
      d[n] = *here;
      inside |= (*here > 0 ? 0U : 1U) << n;
    }
    if (inside == 0 || inside == 255) return {};
    std::array<float, 3> sum{}, slope{};
    float count = 0;
    for (size_t axis = 0; axis < 3; ++axis)
      for (size_t n = 0; n < 8; ++n) {
        if (n >> axis & 1) continue;
        const size_t m = n | size_t{1} << axis;
        slope[axis] += d[m] - d[n];
        if (!crosses(d[n], d[m])) continue;
        for (size_t c = 0; c < 3; ++c) sum[c] += static_cast<float>(n >> c & 1);
        sum[axis] += d[n] / (d[n] - d[m]);
        ++count;
      }
    const float length = std::hypot(slope[0], slope[1], slope[2]);
    if (count == 0 || length == 0) return {};
    SceneMesh::Vertex vertex{};
    for (size_t c = 0; c < 3; ++c) {
      vertex.place[c] = data_.voxel * (static_cast<float>(cell[c]) + 0.5F + sum[c] / count);
      vertex.normal[c] = slope[c] / length;
    }
    vertex.reflectance = color_in(cell);
    return vertex;
  }
  std::array<float, 3> color_in(const Cell& cell) const {
    std::array<float, 3> sum{};
    float total = 0;
    for (size_t n = 0; n < 8; ++n) {
      const size_t at = *find(corner(cell, n)),
                   from = 2 * VolumeData::kBlockVoxels * (at / VolumeData::kBlockVoxels) +
                          at % VolumeData::kBlockVoxels;
      const uint32_t rg = data_.colors[from], ba = data_.colors[from + VolumeData::kBlockVoxels];
      const auto unit = [](uint32_t bits) { return static_cast<float>(bits & 0xffff) / 65535; };
      const float sure = unit(ba >> 16);
      const std::array<float, 3> u{unit(rg), unit(rg >> 16), unit(ba)};
      for (size_t c = 0; c < 3; ++c) sum[c] += sure * (kLowest + (kHighest - kLowest) * u[c]);
      total += sure;
    }
    for (float& c : sum) c = total > 0 ? std::exp(c / total) : 0;
    return sum;
  }
  /// The faces around the edges from this voxel to the next ones.
  void connect(const Cell& cell) {
    const auto here = distance(cell);
    if (!here) return;
    for (size_t axis = 0; axis < 3; ++axis) {
      Cell next = cell;
      ++next[axis];
      const auto there = distance(next);
      if (!there || !crosses(*here, *there)) continue;
      const size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      // The cells around the edge, counterclockwise from its end.
      std::array<uint32_t, 4> around{};
      constexpr std::array<std::array<int, 2>, 4> kAround{{{0, 0}, {-1, 0}, {-1, -1}, {0, -1}}};
      bool whole = true;
      for (size_t k = 0; k < 4; ++k) {
        Cell other = cell;
        other[u] += kAround[k][0];
        other[v] += kAround[k][1];
        const auto at = find(other);
        around[k] = at ? vertex_of_[*at] : kNone;
        whole = whole && around[k] != kNone;
      }
      if (!whole) continue;
      if (*here > 0) std::swap(around[1], around[3]);
      mesh_.triangles.push_back({around[0], around[1], around[2]});
      mesh_.triangles.push_back({around[0], around[2], around[3]});
    }
  }

  const VolumeData& data_;
  std::unordered_map<uint32_t, size_t> blocks_;
  std::vector<uint32_t> vertex_of_;  // of the cell whose first corner a voxel is
  SceneMesh mesh_;
};

uint8_t srgb_of(float linear) {
  const float v = std::clamp(linear, 0.0F, 1.0F);
  const float coded = v <= 0.0031308F ? 12.92F * v : 1.055F * std::pow(v, 1 / 2.4F) - 0.055F;
  return static_cast<uint8_t>(std::lround(255 * coded));
}

template <typename T>
void append(std::string& to, const T& value) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

SceneMesh mesh_of(const VolumeData& data) { return Mesher(data).make(); }

std::string ply_of(const SceneMesh& mesh) {
  std::vector<float> largest;
  for (const auto& vertex : mesh.vertices) largest.push_back(std::ranges::max(vertex.reflectance));
  float scale = 1;
  if (!largest.empty()) {
    const auto at = largest.begin() + static_cast<std::ptrdiff_t>(largest.size() * 99 / 100);
    std::ranges::nth_element(largest, at);
    scale = std::max(*at, 1.0F);
  }
  std::string text =
      "ply\nformat binary_little_endian 1.0\ncomment reflectance, sRGB; meters\n"
      "element vertex " +
      std::to_string(mesh.vertices.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face " +
      std::to_string(mesh.triangles.size()) +
      "\nproperty list uchar uint vertex_indices\nend_header\n";
  for (const auto& vertex : mesh.vertices) {
    append(text, vertex.place);
    append(text, vertex.normal);
    for (const float c : vertex.reflectance) append(text, srgb_of(c / scale));
  }
  for (const auto& triangle : mesh.triangles) {
    append(text, uint8_t{3});
    append(text, triangle);
  }
  return text;
}

}  // namespace inverse
