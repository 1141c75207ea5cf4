// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <functional>
#include <limits>
#include <numbers>

#include "kernels/lightstage/lobe/cosine_lobe.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/lightstage/reference/reflectance_field.hpp"

namespace inverse::testing {

/// A stage and what its cameras see of subjects whose response to each direction is known.
class ReflectanceFieldTest : public GpuTest {
 protected:
  void use_stage(std::vector<Direction> lights) {
    moments = std::make_shared<const LobeMoments>(lights);
    directions = std::move(lights);
    stage = {{directions.begin(), directions.end()}, moments->largest_exponent()};
  }
  /// The two gradients of a pixel that gives `response(w)` of each light's direction w.
  std::pair<reference::Vec3, reference::Vec3> gradients(
      const std::function<reference::Vec3(const reference::Vec3&)>& response) const {
    reference::Vec3 a{}, b{};
    for (const reference::Vec3& w : stage.lights) {
      const reference::Vec3 r = response(w);
      for (size_t c = 0; c < 3; ++c) {
        a[c] += (1 + w[c]) / 2 * r[c];
        b[c] += (1 - w[c]) / 2 * r[c];
      }
    }
    return {a, b};
  }
  struct Pair {
    Pixels a, b;
    void add(const reference::Vec3& one, const reference::Vec3& other) {
      for (size_t c = 0; c < 3; ++c) {
        a.push_back(static_cast<float>(one[c]));
        b.push_back(static_cast<float>(other[c]));
      }
      a.push_back(0.5F);
      b.push_back(0.25F);
    }
    Extent extent() const { return {static_cast<uint32_t>(a.size() / 4), 1}; }
  };
  CosineLobe lobe_method(Extent extent) { return {device, extent, moments, directions}; }
  /// What was found for pixel i: of `lobes` and `full` as they were downloaded.
  static reference::CosineLobe found(const Pixels& full, const Pixels& lobes, size_t i) {
    reference::CosineLobe lobe;
    for (size_t c = 0; c < 3; ++c) lobe.full[c] = full[4 * i + c];
    const double x = lobes[4 * i], y = lobes[4 * i + 1], z = lobes[4 * i + 2];
    lobe.share = std::hypot(x, y, z);
    lobe.direction = lobe.share > 1e-6
                         ? reference::Vec3{x / lobe.share, y / lobe.share, z / lobe.share}
                         : reference::Vec3{0, 0, 1};
    lobe.exponent = lobes[4 * i + 3];
    return lobe;
  }
  static double degrees(const reference::Vec3& a, const reference::Vec3& b) {
    const double cosine =
        reference::dot(a, b) / std::sqrt(reference::dot(a, a) * reference::dot(b, b));
    return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
  }
  static reference::Vec3 any_direction(std::mt19937& random) {
    std::normal_distribution<double> normal;
    reference::Vec3 u{normal(random), normal(random), normal(random)};
    const double length = std::sqrt(reference::dot(u, u));
    for (double& x : u) x /= length;
    return u;
  }

  std::vector<Direction> directions;
  std::shared_ptr<const LobeMoments> moments;
  reference::Stage stage;
};

}  // namespace inverse::testing
