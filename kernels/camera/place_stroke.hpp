// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <optional>
#include <span>

#include "kernels/camera/camera.hpp"
#include "kernels/image/strokes/stroke.hpp"

namespace inverse {

/// What a camera sees of a remembered scene, on the host. It shows what the frame shows, in a size
/// of its own.
struct SceneView {
  Extent extent;
  Lens lens;
  Pose pose;
  std::span<const float> depth;  ///< meters along the optical axis, 0 where nothing is known
};

/// A stroke that was drawn on a frame of size `frame`, put onto the surfaces under it: balls at
/// most some half a radius apart, of the size that the brush has on them. Nothing if no surface is
/// known under it.
std::optional<Stroke> placed_in_scene(const Stroke& stroke, Extent frame, const SceneView& view);

/// Radius in meters that a brush of `radius` pixels of a frame has at a place of the scene.
float radius_in_scene(float radius, const std::array<float, 3>& place, Extent frame,
                      const SceneView& view);

/// Whether a stroke in the scene, or what lies in front of or behind it, is seen at a point of a
/// frame of size `frame`.
bool covers(const Stroke& stroke, Stroke::Point point, Extent frame, const SceneView& view);

}  // namespace inverse
