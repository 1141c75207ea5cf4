// SPDX-License-Identifier: LGPL-2.1-or-later
#include "clone_room.hpp"

#include <algorithm>
#include <cmath>

namespace inverse {

std::optional<std::array<float, 3>> CloneView::place(double x, double y, Extent frame) const {
  const double u = (x + 0.5) * extent.width / frame.width,
               v = (y + 0.5) * extent.height / frame.height;
  if (surface.empty() || !(u >= 0 && v >= 0 && u < extent.width && v < extent.height)) return {};
  const size_t at = static_cast<size_t>(v) * extent.width + static_cast<size_t>(u);
  const float depth = surface[4 * at + 3];
  if (!(depth > 0)) return {};
  return to_world(pose, {depth * (static_cast<float>(u) - 0.5F - lens.cx) / lens.fx,
                         depth * (static_cast<float>(v) - 0.5F - lens.cy) / lens.fy, depth});
}

std::optional<CloneView> CloneRoom::see(const FrameContext& frame, bool with_surface) {
  const SeenScene& scene = *frame.layers.scene;
  reads_.begin();
  const auto copy = [&](const gpu::BufferPtr& from, gpu::BufferPtr& to) {
    if (!to || to->count() != from->count())
      to = gpu::Buffer::create(reads_.device(), gpu::Element::vec4, from->count(),
                               gpu::Memory::readback);
    reads_.copy(from, to, from->bytes());
  };
  copy(scene.pose->buffer, pose_);
  if (with_surface) copy(scene.surface->buffer, surface_);
  reads_.submit();
  frame.wait(reads_);
  const auto* values = pose_->map_as<float>();
  if (!(values[8] > 0)) return {};
  CloneView view{.extent = scene.extent, .lens = scene.lens, .pose = {}, .surface = {}};
  std::copy_n(values, 4, view.pose.rotation.begin());
  std::copy_n(values + 4, 3, view.pose.place.begin());
  if (with_surface) {
    const auto* pixels = surface_->map_as<float>();
    view.surface.assign(pixels, pixels + 4 * scene.extent.pixels());
  }
  return view;
}

}  // namespace inverse
