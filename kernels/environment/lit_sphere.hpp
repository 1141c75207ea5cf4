#pragma once
#include <array>
#include <memory>
#include <optional>

#include "environment.hpp"
#include "kernels/environment_lit_sphere.spv.hpp"
#include "kernels/gpu/commands.hpp"
#include "prefiltered_light.hpp"

namespace inverse {

/// What a surface gives back of light: diffuse * D + specular * lobe_gain(shininess) * S (thesis
/// Eq. 6.2).
struct Surface {
  std::array<float, 3> diffuse{0.5F, 0.5F, 0.5F};  ///< albedo, linear RGB
  float specular = 0;                              ///< albedo, white
  float shininess = 2;                             ///< exponent, 1 to 1024
  bool operator==(const Surface&) const = default;

  /// Keeps sharp lobes visible: 1 for wide ones.
  static float lobe_gain(float shininess) { return shininess > 8 ? (shininess + 8) / 16 : 1; }
};

/// Whether two surfaces look the same, to half a hundredth of their albedos and what an exponent
/// can tell: who draws one need not be told of the other.
bool alike(const Surface& a, const Surface& b);
/// Whether two maps differ by less than a hundredth of what light there is.
bool alike(const Environment& a, const Environment& b);

/// How a material looks under a light, by the normal alone: the viewer is far away, so that nothing
/// else matters (a lit sphere). A table over the normals that face the camera holds linear RGB
/// md D(n) + ms S(n); kernels look into it through lit_sphere.glsl.
///
/// D is a sum over 512 cells of the map, exact where a cell is seen whole or not at all, and so is
/// S of wide lobes. Of narrower ones it takes samples around the normal, (h·n)^s over half vectors,
/// from levels of the map that are as blurred as the samples are far apart.
class LitSphere {
 public:
  /// `side`: of the table. Normals are 2.3 / side apart, the same everywhere.
  explicit LitSphere(const std::shared_ptr<gpu::Device>& device, uint32_t side = 160);

  /// Takes this light from the next `record` on. Costs some milliseconds of the caller's, of large
  /// maps seconds; nearly nothing where the light was made ready before.
  void set_light(const Environment& environment) { set_light(PrefilteredLight(environment)); }
  void set_light(const PrefilteredLight& light);

  struct View {
    float intensity = 1;  ///< factor on the light
    float rotation = 0;   ///< of the light about y in radian: what came from +z then comes from +x
    bool operator==(const View&) const = default;
  };
  /// Records what is to do where surface, view or light are not those of the call before: nothing
  /// where they are. What is not finite or out of range is bounded. Throws Error(internal) without
  /// a light.
  void record(gpu::Commands& commands, const Surface& surface, const View& view);
  /// What was recorded may not have been computed: the next `record` records all.
  void forget() { recorded_.reset(); }
  /// The table of the last `record`: side x side, rows from the top (y up). One buffer, written
  /// again with each change, in the order of submits.
  const Plane& table() const { return table_; }
  /// How often the table changed: who keeps what was drawn from it compares.
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
  std::optional<State> recorded_;
  uint64_t version_ = 0;
};

}  // namespace inverse
