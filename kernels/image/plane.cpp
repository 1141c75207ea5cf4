// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plane.hpp"

namespace inverse {

PlanePool::PlanePool(std::shared_ptr<gpu::Device> device, Extent extent)
    : device_(std::move(device)), extent_(extent) {}

PlanePtr PlanePool::acquire() {
  gpu::BufferPtr buffer;
  {
    std::lock_guard lock(shelf_->mutex);
    if (!shelf_->buffers.empty()) {
      buffer = std::move(shelf_->buffers.back());
      shelf_->buffers.pop_back();
    }
  }
  if (!buffer) buffer = gpu::Buffer::create(device_, gpu::Element::vec4, extent_.pixels());
  return {new Plane{extent_, std::move(buffer)},
          [shelf = std::weak_ptr<Shelf>(shelf_)](Plane* plane) {
            if (auto alive = shelf.lock()) {
              std::lock_guard lock(alive->mutex);
              alive->buffers.push_back(std::move(plane->buffer));
            }
            delete plane;
          }};
}

}  // namespace inverse
