// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <functional>
#include <memory>
#include <span>

#include "head_scene.hpp"
#include "olat_stack.hpp"

namespace inverse {

/// Renders the virtual head under one light after another into a stack of images: ray-marched once,
/// then shaded for each light with Lambert's law, GGX highlights and soft shadows. Waits until
/// done; returns false if `go_on` returned false meanwhile. `side`: samples along each side of a
/// pixel.
bool render_head(OlatStack& stack, std::span<const Direction> lights, const HeadView& view,
                 const std::function<bool()>& go_on = {}, uint32_t side = 2);

/// The visible surface, in the layout of surface.comp.
struct HeadSurface {
  Plane position, normal, albedo;
};
HeadSurface make_head_surface(const std::shared_ptr<gpu::Device>& device, Extent extent);
/// Records `count` of its pixels from `first` on.
void record_head_surface(gpu::Commands& commands, const HeadSurface& surface, const HeadView& view,
                         uint32_t first, uint32_t count);

}  // namespace inverse
