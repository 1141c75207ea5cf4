// SPDX-License-Identifier: LGPL-2.1-or-later
// Specification of kernels/virtual_room: painted solids, lamps, and light from all around.
#pragma once
#include <vector>

#include "tests/reference/volume/volume.hpp"

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

  /// What a ray meets first.
  struct Seen {
    double along;
    size_t solid;
    Vec3 reflectance;
    double direct;    ///< light of lamps
    double openness;  ///< share of the light from all around, exact at this place
  };
  Seen look(const Vec3& from, const Vec3& along) const;
};

}  // namespace inverse::reference
