// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "kernels/lightstage_virtual_stage_surface.spv.hpp"

namespace inverse {

/// The head of the virtual stage: joined and carved ellipsoids, and their materials. One unit is
/// about 12 cm; x right, y up, z to camera 0; the origin is between the ears.
struct HeadScene {
  using Vec4 = std::array<float, 4>;
  enum Material : uint8_t { skin, lips, hair, eye, cloth };
  static constexpr uint32_t kPrimitiveVec4s =
      shaders::lightstage_virtual_stage_surface::kPrimitiveVec4s;

  /// In the layout of head.glsl: kPrimitiveVec4s per primitive.
  std::vector<Vec4> primitives;
  /// In the layout of surface.comp: two per Material.
  std::vector<Vec4> materials;
  uint32_t count() const { return static_cast<uint32_t>(primitives.size()) / kPrimitiveVec4s; }
};

/// The built-in head.
const HeadScene& virtual_head();

/// A camera position.
struct HeadView {
  float turn = 0;  ///< of the camera about the vertical, radian: positive shows more of the right
                   ///< side
  float distance = 7;
  float height = 2.6F;    ///< of the field of view at the axis
  float center = -0.15F;  ///< of the field of view, above the origin
  std::array<float, 3> eye() const;
};

/// The view of a camera of this number: 0 from the front, others from both sides alternately.
HeadView view_of_camera(uint32_t camera);

}  // namespace inverse
