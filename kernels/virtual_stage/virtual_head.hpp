#pragma once
#include <functional>
#include <memory>
#include <span>

#include "head_scene.hpp"
#include "olat_stack.hpp"

namespace inverse {

/// Renders the virtual head under one light after the other into a stack of images: ray-marched
/// once, then shaded for each light with Lambert's law, GGX highlights and soft shadows. Waits
/// until it is done; where `go_on` says no meanwhile it stops and gives false. `side`: samples
/// along each side of a pixel.
bool render_head(OlatStack& stack, std::span<const Direction> lights, const HeadView& view,
                 const std::function<bool()>& go_on = {}, uint32_t side = 2);

/// The surface that a camera sees of it, as surface.comp has it.
struct HeadSurface {
  Plane position, normal, albedo;
};
HeadSurface make_head_surface(const std::shared_ptr<gpu::Device>& device, Extent extent);
/// Records `count` pixels of it from `first` on.
void record_head_surface(gpu::Commands& commands, const HeadSurface& surface, const HeadView& view,
                         uint32_t first, uint32_t count);

}  // namespace inverse
