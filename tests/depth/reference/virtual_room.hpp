// SPDX-License-Identifier: LGPL-2.1-or-later
// Specification of kernels/depth/virtual_room: painted solids, lamps, and light from all around.
#pragma once
#include <vector>

#include "tests/reference/camera/volume.hpp"

namespace inverse::reference {

struct RoomSolid {
  enum class Kind { box, ball, inside } kind;
  Vec3 center, half_size;
  double turn;  ///< about y, radians
  enum class Paint { plain, checker, stripes, rings, letters } paint;
  double side;
  Vec3 color, other;
};

struct Room {
  std::vector<RoomSolid> solids;
  struct Lamp {
    Vec3 place;
    double power;
  };
  std::vector<Lamp> lamps;
  double ambient;
  /// All within a radius of a line. Casts shadows; light from all around is the same everywhere on
  /// it, and passes it.
  struct Part {
    Vec3 from, to;
    double radius;
    Vec3 color;
  };
  std::vector<Part> hand = {};

  /// What a ray meets first.
  struct Seen {
    double along;
    size_t solid;  ///< after the solids the parts of the hand
    Vec3 reflectance;
    double direct;    ///< light of lamps
    double openness;  ///< share of the light from all around, exact at this place
  };
  Seen look(const Vec3& from, const Vec3& along) const;

 private:
  bool open(const Vec3& from, const Vec3& along, double reach) const;
  double lit(const Vec3& from, const Vec3& normal) const;
};

}  // namespace inverse::reference
