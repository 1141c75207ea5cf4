// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "kernels/image/place.hpp"

namespace inverse {

/// A lamp that is added to a scene.
///
/// Axes: x to the right, y down, z towards the viewer. Its place is seen at the pixel x, y of the
/// frame, z above the picture plane: in widths of the frame, or in meters if depth is known. A lamp
/// in the room has the axes of a remembered scene instead, those of SeenScene::pose.
struct Lamp {
  enum class Kind : uint8_t { point, spot, directional };
  using Vector = std::array<float, 3>;

  Kind kind = Kind::point;
  Vector position{};           ///< x and y in pixels
  Vector direction{0, 0, -1};  ///< that its light goes; of spot and directional
  uint32_t color = 0xffffff;   ///< 0xRRGGBB, sRGB
  /// Shading of a surface that faces it, of white light, at a distance of 1; of directional lamps
  /// at any.
  float power = 0.1F;
  float angle = 30;       ///< of a spot: between the axis and the edge of its cone, degrees
  float softness = 0.3F;  ///< of a spot: share of the angle inside of the edge in which light falls
  /// Distances below count as this one: of point and spot. Unit of z.
  float radius = 0.02F;
  /// In the room: position and direction are in the axes of the scene, meters.
  bool room = false;

  bool operator==(const Lamp&) const = default;
};

constexpr size_t kMaxLamps = 8;

struct LampList {
  Extent frame;  ///< of which positions are pixels
  std::vector<Lamp> lamps;
};

/// Where a lamp that is not in the room is seen in a frame. A directional one is where its light
/// would be brightest on a ball that fills the frame.
Place place_of(const Lamp& lamp, Extent frame);
/// Moves a lamp there; z stays, as do the directions of spots.
void move_to(Lamp& lamp, Place place, Extent frame);

/// How pixels of a frame are places in the scene: of pixel p at height z above the picture plane,
/// x = (p − center) · scale(z).
struct View {
  Extent frame;
  /// Pixels; 0: there is no depth, and the view is along z: scale = 1 / width.
  float focal_length = 0;
  /// Of the picture plane from the camera, meters: scale(z) = (plane_depth − z) / focal_length.
  float plane_depth = 0;

  Lamp::Vector place(float x, float y, float z) const;
  /// From the camera of a height above the picture plane, meters.
  float depth(float z) const;
};

/// A table for apply.comp: kLampRows (relight.glsl) vec4 for each of the first kMaxLamps. Those in
/// the room are for place.comp; with `in_scene` the others are, too.
std::vector<std::array<float, 4>> lamp_table(const std::vector<Lamp>& lamps, float strength,
                                             const View& view, bool in_scene = false);

}  // namespace inverse
