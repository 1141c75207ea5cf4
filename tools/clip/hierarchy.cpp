// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hierarchy.hpp"

#include <utility>

namespace inverse::clip {
namespace {

Vec3 center(const Primitive& primitive) {
  Bounds b = bounds(primitive);
  return (b.low + b.high) * 0.5f;
}

Bounds join(const Bounds& a, const Bounds& b) { return {min(a.low, b.low), max(a.high, b.high)}; }

float area(const Bounds& box) {
  Vec3 e = box.high - box.low;
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

/// Distance at which the ray enters the box, or infinity.
float entry(const Bounds& box, Vec3 origin, Vec3 inverse, float limit) {
  Vec3 a = (box.low - origin) * inverse, b = (box.high - origin) * inverse;
  Vec3 low = min(a, b), high = max(a, b);
  float enter = std::max(std::max(low.x, low.y), std::max(low.z, 0.0f));
  float leave = std::min(std::min(high.x, high.y), std::min(high.z, limit));
  return enter <= leave ? enter : 1e30f;
}

Ray to_local(const Primitive& primitive, const Ray& ray) {
  return {primitive.frame.to_local(ray.origin - primitive.position),
          primitive.frame.to_local(ray.direction)};
}

}  // namespace

Hierarchy::Hierarchy(std::vector<Primitive> primitives) : primitives_(std::move(primitives)) {
  nodes_.reserve(2 * primitives_.size());
  build(0, static_cast<int>(primitives_.size()));
}

int Hierarchy::build(int begin, int end) {
  int index = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  if (end - begin == 1) {
    nodes_[index] = {bounds(primitives_[begin]), begin, true};
    return index;
  }
  // Surface-area heuristic over all splits along each axis; there are about a hundred primitives.
  float best_cost = 1e30f;
  int best_axis = 0, best_split = begin + 1;
  for (int axis = 0; axis < 3; ++axis) {
    sort_along(axis, begin, end);
    std::vector<float> cost_after(static_cast<size_t>(end - begin), 0);
    Bounds after, before;
    for (int i = end - 1; i > begin; --i) {
      after = join(after, bounds(primitives_[i]));
      cost_after[i - begin] = area(after) * static_cast<float>(end - i);
    }
    for (int i = begin + 1; i < end; ++i) {
      before = join(before, bounds(primitives_[i - 1]));
      float cost = area(before) * static_cast<float>(i - begin) + cost_after[i - begin];
      if (cost < best_cost) best_cost = cost, best_axis = axis, best_split = i;
    }
  }
  sort_along(best_axis, begin, end);
  int left = build(begin, best_split);
  int right = build(best_split, end);
  nodes_[index] = {join(nodes_[left].bounds, nodes_[right].bounds), right, false};
  return index;
}

void Hierarchy::sort_along(int axis, int begin, int end) {
  std::sort(primitives_.begin() + begin, primitives_.begin() + end,
            [axis](const auto& a, const auto& b) { return center(a)[axis] < center(b)[axis]; });
}

template <typename Visit>
void Hierarchy::traverse(const Ray& ray, float limit, Visit&& visit) const {
  struct Pending {
    int node;
    float entry;
  };
  Vec3 inverse{1 / ray.direction.x, 1 / ray.direction.y, 1 / ray.direction.z};
  Pending stack[64];
  int depth = 0;
  stack[depth++] = {0, 0};
  while (depth > 0) {
    Pending next = stack[--depth];
    if (next.entry >= limit) continue;
    const Node& node = nodes_[next.node];
    if (node.leaf) {
      if (visit(primitives_[node.second], limit)) return;
      continue;
    }
    Pending a{next.node + 1, entry(nodes_[next.node + 1].bounds, ray.origin, inverse, limit)};
    Pending b{node.second, entry(nodes_[node.second].bounds, ray.origin, inverse, limit)};
    if (a.entry < b.entry) std::swap(a, b);
    if (a.entry < limit) stack[depth++] = a;
    if (b.entry < limit) stack[depth++] = b;
  }
}

Hit Hierarchy::closest(const Ray& ray) const {
  Hit hit;
  const Primitive* found = nullptr;
  Vec3 local_normal;
  traverse(ray, 1e30f, [&](const Primitive& primitive, float& limit) {
    if (auto local = intersect(primitive, to_local(primitive, ray), limit)) {
      limit = local->distance;
      local_normal = local->normal;
      found = &primitive;
      hit.distance = limit;
    }
    return false;
  });
  if (!found) return hit;
  hit.surface = static_cast<int>(found - primitives_.data());
  hit.position = ray.origin + ray.direction * hit.distance;
  hit.reflectance = reflectance(found->paint, found->frame.to_local(hit.position - found->position),
                                local_normal);
  hit.normal = found->frame.to_world(local_normal);
  if (dot(hit.normal, ray.direction) > 0) hit.normal = -hit.normal;
  return hit;
}

bool Hierarchy::occluded(const Ray& ray, float limit) const {
  bool blocked = false;
  traverse(ray, limit, [&](const Primitive& primitive, float& reach) {
    blocked = intersect(primitive, to_local(primitive, ray), reach).has_value();
    return blocked;
  });
  return blocked;
}

}  // namespace inverse::clip
