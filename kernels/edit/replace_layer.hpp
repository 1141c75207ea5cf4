// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <utility>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"

namespace inverse {

/// The plane to write the edited `plane` to: itself if nothing else holds it, else a new one.
inline PlanePtr plane_to_edit(const PlanePtr& plane, PlanePool& planes) {
  return plane.use_count() == 1 ? plane : planes.acquire();
}

/// Puts `plane` in the place of a layer. The one before stays until this work is done, whoever else
/// releases it: its pool may belong to another thread, which would write to it first.
inline void replace(gpu::Commands& commands, Layers& layers, Role role, PlanePtr plane) {
  if (layers[role] != plane) commands.keep(std::exchange(layers[role], std::move(plane)));
}

}  // namespace inverse
