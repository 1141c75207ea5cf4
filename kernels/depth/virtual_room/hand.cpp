// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hand.hpp"

#include <algorithm>
#include <cmath>

#include "virtual_room.hpp"

namespace inverse {
namespace {

using Vec3 = std::array<float, 3>;

constexpr Vec3 kSkin{0.5F, 0.28F, 0.19F}, kSleeve{0.16F, 0.2F, 0.28F};
// In the camera's axes: where the arm begins, and the tip of the finger while it is out of sight.
constexpr Vec3 kShoulder{0.4F, 0.28F, -0.05F}, kRest{0.3F, 0.45F, 0.1F};

Vec3 moved(const Vec3& a, float t, const Vec3& b) {
  return {a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]};
}
Vec3 minus(const Vec3& a, const Vec3& b) { return moved(a, -1, b); }
float length(const Vec3& v) { return std::hypot(v[0], v[1], v[2]); }
Vec3 unit(const Vec3& v) { return moved({}, 1 / length(v), v); }
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

struct Spot {
  Vec3 place, normal;
};
/// On the surfaces of furnished_room.
Spot spot_of(HandTarget target) {
  const auto on_ball = [](const Vec3& center, float radius, const Vec3& along) {
    return Spot{moved(center, radius, unit(along)), unit(along)};
  };
  switch (target) {
    case HandTarget::none:
      break;
    case HandTarget::ball:
      return on_ball({0.3F, 0.33F, 0}, 0.14F, {-0.3F, -0.8F, -0.5F});
    case HandTarget::dark_ball:
      return on_ball({-0.1F, 0.38F, 0.3F}, 0.09F, {0, -0.8F, -0.6F});
    case HandTarget::box:
      return {{-0.35F, 0.23F, 0.05F}, {0, -1, 0}};
    case HandTarget::book:
      return {{0.05F, 0.44F, -0.15F}, {0, -1, 0}};
    case HandTarget::table:
      return {{-0.3F, 0.47F, -0.2F}, {0, -1, 0}};
    case HandTarget::print:
      return {{0.1F, -0.25F, 2.094F}, {0, 0, -1}};
  }
  return {};
}

/// 0 before `from`, 1 after `to`, smooth between.
float ramp(double from, double to, double at) {
  const double t = std::clamp((at - from) / (to - from), 0.0, 1.0);
  return static_cast<float>(t * t * (3 - 2 * t));
}

/// From outside to the surface, meters; negative inside.
float distance_to(const Solid& solid, const Vec3& point) {
  const Vec3 p = minus(point, solid.center);
  if (solid.kind == Solid::Kind::ball) return length(p) - solid.half_size[0];
  const float c = std::cos(solid.turn), s = std::sin(solid.turn);
  const Vec3 in{c * p[0] - s * p[2], p[1], s * p[0] + c * p[2]};
  Vec3 beyond{};
  float inside = -1e9F;
  for (size_t k = 0; k < 3; ++k) {
    const float d = std::abs(in[k]) - solid.half_size[k];
    beyond[k] = std::max(d, 0.0F);
    inside = std::max(inside, d);
  }
  const float box = length(beyond) + std::min(inside, 0.0F);
  return solid.kind == Solid::Kind::inside ? -box : box;
}

}  // namespace

Hand room_hand(HandTarget target, const Pose& camera, double seconds) {
  if (target == HandTarget::none) return {};
  const double t = std::fmod(seconds, kHandPeriod);
  const Spot spot = spot_of(target);
  const Vec3 shoulder = to_world(camera, kShoulder), rest = to_world(camera, kRest);
  Hand hand{
      .parts = {}, .contact = spot.place, .normal = spot.normal, .touches = t >= 3 && t < 4.2};
  const float height = 0.1F - 0.05F * ramp(1.9, 2.2, t) - 0.05F * ramp(2.7, 3, t) +
                       0.1F * ramp(4.2, 4.6, t),
              there = ramp(0.5, 1.5, t) - ramp(4.6, 5.5, t);
  const Vec3 above = moved(spot.place, kFingerRadius + height, spot.normal),
             tip = moved(rest, there, minus(above, rest)), back = unit(minus(shoulder, tip));
  // The hand comes from the side, so that the arm does not hide it; the finger points onto the
  // surface, the back of the hand is raised a little.
  const Vec3 right = minus(to_world(camera, {1, 0, 0}), to_world(camera, {0, 0, 0}));
  const Vec3 finger = unit(moved(moved(back, 3.5F, right), 2 * there, spot.normal)),
             palm = unit(moved(moved(back, 1.5F, right), 0.7F * there, spot.normal)),
             side = unit(cross(finger, spot.normal));
  const Vec3 knuckle = moved(tip, 0.085F, finger), wrist = moved(knuckle, 0.1F, palm),
             elbow = moved(wrist, 0.24F, unit(minus(shoulder, wrist)));
  hand.parts.push_back({tip, knuckle, kFingerRadius, kSkin});
  for (const float along : {-0.022F, 0.02F, 0.04F}) {
    const Vec3 root = moved(moved(knuckle, 0.01F, palm), along, side);
    hand.parts.push_back({root, moved(root, -0.035F, finger), 0.01F, kSkin});
  }
  hand.parts.push_back({moved(knuckle, 0.025F, palm), wrist, 0.034F, kSkin});
  hand.parts.push_back({wrist, elbow, 0.03F, kSkin});
  hand.parts.push_back({elbow, shoulder, 0.045F, kSleeve});
  return hand;
}

float clearance(const RoomScene& scene, const std::vector<HandPart>& parts) {
  constexpr float kStep = 0.002F;  // meters
  float nearest = 1e9F;
  for (const HandPart& part : parts) {
    const Vec3 along = minus(part.to, part.from);
    const int steps = static_cast<int>(length(along) / kStep) + 1;
    for (int n = 0; n <= steps; ++n) {
      const Vec3 at = moved(part.from, static_cast<float>(n) / static_cast<float>(steps), along);
      for (const Solid& solid : scene.solids)
        nearest = std::min(nearest, distance_to(solid, at) - part.radius);
    }
  }
  return std::max(nearest, 0.0F);
}

}  // namespace inverse
