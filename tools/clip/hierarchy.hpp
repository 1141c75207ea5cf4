// SPDX-License-Identifier: LGPL-2.1-or-later
// Bounding-volume hierarchy over the primitives of one frame.
#pragma once

#include <vector>

#include "shapes.hpp"

namespace inverse::clip {

struct Hit {
  float distance = 1e30f;
  Vec3 position, normal;  ///< world; the normal faces the ray's origin
  Vec3 reflectance;       ///< linear RGB
  int surface = -1;       ///< which primitive; -1 where the ray meets nothing
};

class Hierarchy {
 public:
  explicit Hierarchy(std::vector<Primitive> primitives);

  /// First surface along the ray.
  Hit closest(const Ray& ray) const;

  /// True if something lies between the ray's origin and `limit` meters along it.
  bool occluded(const Ray& ray, float limit) const;

 private:
  struct Node {
    Bounds bounds;
    int second = 0;  ///< inner: the right child (the left is the next node); leaf: the primitive
    bool leaf = false;
  };

  int build(int begin, int end);
  void sort_along(int axis, int begin, int end);

  /// Calls visit(primitive, limit) for every leaf that the ray meets, nearest box first;
  /// visit may lower the limit and returns true to stop.
  template <typename Visit>
  void traverse(const Ray& ray, float limit, Visit&& visit) const;

  std::vector<Primitive> primitives_;
  std::vector<Node> nodes_;
};

}  // namespace inverse::clip
