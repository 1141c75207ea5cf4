// SPDX-License-Identifier: LGPL-2.1-or-later
// The scene of the bundled clip: a still life on a dark wooden table, a lamp that swings past and
// a ball that rolls by.
#pragma once

#include <vector>

#include "shapes.hpp"

namespace inverse::clip {

/// A round lamp, white, radiating alike in all directions.
struct Lamp {
  Vec3 position;
  float radius;     ///< meters
  float intensity;  ///< irradiance × π⁻¹ at one meter, facing
};

/// A window: a white rectangle that radiates into the room.
struct Window {
  Vec3 corner, edge_u, edge_v;  ///< the normal is cross(edge_u, edge_v)
  float radiance;
};

struct Camera {
  Vec3 position, target;
  float vertical_angle;  ///< radians
};

struct Scene {
  std::vector<Primitive> primitives;
  Lamp lamp;
  Window window;
  Camera camera;
};

/// The scene at `time` in 0…1 of the clip's length.
Scene still_life(float time);

}  // namespace inverse::clip
