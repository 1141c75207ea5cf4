// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "environment.hpp"
#include "kernels/environment_lit_sphere.spv.hpp"
#include "kernels/gpu/commands.hpp"
#include "prefiltered_light.hpp"

namespace inverse {

/// Reflection of a surface: diffuse * D + specular * lobe_gain(shininess) * S (thesis Eq. 6.2).
struct Surface {
  std::array<float, 3> diffuse{0.5F, 0.5F, 0.5F};  ///< albedo, linear RGB
  float specular = 0;                              ///< albedo, white
  float shininess = 2;                             ///< exponent, 1 to 1024
  bool operator==(const Surface&) const = default;

  /// Gain that keeps sharp lobes visible; 1 for wide ones.
  static float lobe_gain(float shininess) { return shininess > 8 ? (shininess + 8) / 16 : 1; }
};

/// Whether two surfaces look the same: albedos within 0.005, and indistinguishable exponents. Then
/// drawings need no update.
bool alike(const Surface& a, const Surface& b);
/// Whether two maps differ by less than 1 % of their light.
bool alike(const Environment& a, const Environment& b);

/// Shading of a material by the normal alone (a lit sphere); the viewer is far away. A table over
/// the normals that face the camera holds linear RGB md D(n) + ms S(n); kernels look it up through
/// lit_sphere.glsl.
///
/// D, and S of wide lobes, are sums over 512 cells of the map, exact if a cell is entirely above or
/// below the horizon. S of narrower lobes uses samples around the normal, (h·n)^s over half
/// vectors, from levels of the map as blurred as the samples are far apart.
class LitSphere {
 public:
  /// `side`: of the table. Normals are 2.3 / side apart everywhere.
  explicit LitSphere(const std::shared_ptr<gpu::Device>& device, uint32_t side = 160);

  /// Uses this light from the next `record` on. Takes some milliseconds on the host, seconds for
  /// large maps, nearly nothing if the light was prepared before.
  void set_light(const Environment& environment) { set_light(PrefilteredLight(environment)); }
  void set_light(const PrefilteredLight& light);

  struct View {
    float intensity = 1;  ///< factor on the light
    float rotation = 0;   ///< of the light about y in radian: what came from +z then comes from +x
    /// Unit quaternion (x, y, z, w) that turns directions of the table into those of the light.
    std::array<float, 4> viewer{0, 0, 0, 1};
    bool operator==(const View&) const = default;
  };
  /// Records the update of the table if surface, view or light changed since the last call. Clamps
  /// values that are not finite or out of range. Throws Error(internal) without a light.
  void record(gpu::Commands& commands, const Surface& surface, const View& view);
  /// Invalidates the table: recorded work may not have run. The next `record` updates it.
  void forget() { recorded_.reset(); }
  /// The table of the last `record`: side x side, rows from the top (y up). One buffer, rewritten
  /// with each change, in the order of submits.
  const Plane& table() const { return table_; }
  /// Of the light: PrefilteredLight::cells.
  const std::vector<PrefilteredLight::Vec4>& cells() const { return cells_; }
  /// Number of lights so far.
  uint64_t lights() const { return lights_; }
  /// Number of changes of the table: compare it to reuse what was drawn from it.
  uint64_t version() const { return version_; }

 private:
  struct Light;
  struct State {
    Surface surface;
    View view;
    bool operator==(const State&) const = default;
  };
  Plane table_;
  gpu::Program<shaders::environment_lit_sphere> kernel_;
  std::shared_ptr<const Light> light_;
  gpu::BufferPtr samples_;
  std::optional<State> recorded_;
  std::vector<PrefilteredLight::Vec4> cells_;
  uint64_t version_ = 0, lights_ = 0;
};

}  // namespace inverse
