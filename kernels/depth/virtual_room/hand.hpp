// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "kernels/camera/camera.hpp"

namespace inverse {

struct RoomScene;

/// All that is within `radius` of a line (hand.glsl). Meters.
struct HandPart {
  std::array<float, 3> from{}, to{};
  float radius = 0;
  std::array<float, 3> color{};  ///< reflectance, linear
};

/// What the hand in the furnished room touches.
enum class HandTarget : uint8_t {
  none,       ///< there is no hand
  ball,       ///< the red and white ball on the table
  dark_ball,  ///< the black one
  box,        ///< the box with print, from above
  book,
  table,
  print,  ///< on the wall
};

/// A hand at one time.
struct Hand {
  std::vector<HandPart> parts;     ///< the first one is the finger, from its tip on
  std::array<float, 3> contact{};  ///< where it touches, when it does
  std::array<float, 3> normal{};   ///< of the surface there
  bool touches = false;
};
constexpr double kHandPeriod = 6;        ///< seconds
constexpr float kFingerRadius = 0.008F;  ///< meters

/// The arm of who carries the camera: once in kHandPeriod it comes into sight, waits some
/// centimeters above its target (until second 2.7), touches it (3 to 4.2) and leaves.
Hand room_hand(HandTarget target, const Pose& camera, double seconds);

/// Distance of the parts to the nearest solid, meters; 0 if they touch.
float clearance(const RoomScene& scene, const std::vector<HandPart>& parts);

}  // namespace inverse
