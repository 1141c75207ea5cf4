#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace inverse {

/// The head of the virtual stage: ellipsoids that are joined or carved, and what they are made of.
/// Units are about 12 cm; x right, y up, z to camera 0; the origin is between the ears.
struct HeadScene {
  using Vec4 = std::array<float, 4>;
  enum Material : uint8_t { skin, lips, hair, eye, cloth };
  static constexpr uint32_t kPrimitiveVec4s = 4;

  /// As head.glsl reads them: four for each primitive.
  std::vector<Vec4> primitives;
  /// As surface.comp reads them: two for each Material.
  std::vector<Vec4> materials;
  uint32_t count() const { return static_cast<uint32_t>(primitives.size()) / kPrimitiveVec4s; }
};

/// The one head there is.
const HeadScene& virtual_head();

/// From where it is looked at.
struct HeadView {
  float turn = 0;  ///< of the camera about the vertical, radian: positive sees more of the right
  float distance = 7;
  float height = 2.6F;    ///< of what is seen at the axis
  float center = -0.15F;  ///< of that, above the origin
  std::array<float, 3> eye() const;
};

/// The view of a camera of this number: 0 from the front, others from both sides by turns.
HeadView view_of_camera(uint32_t camera);

}  // namespace inverse
