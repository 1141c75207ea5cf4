#pragma once
#include <memory>
#include <span>

#include "head_scene.hpp"
#include "olat_stack.hpp"

namespace inverse {

/// Renders the virtual head under one light after the other into a stack of images: ray-marched
/// once, then shaded for each light with Lambert's law, GGX highlights and soft shadows. Waits
/// until it is done. `side`: samples along each side of a pixel.
void render_head(OlatStack& stack, std::span<const Direction> lights, const HeadView& view,
                 uint32_t side = 2);

/// The surface that a camera sees of it (surface.comp), for tests.
struct HeadSurface {
  Plane position, normal, albedo;
};
HeadSurface record_head_surface(gpu::Commands& commands, Extent extent, const HeadView& view);

}  // namespace inverse
