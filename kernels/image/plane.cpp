// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plane.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace inverse {

PlanePool::PlanePool(std::shared_ptr<gpu::Device> device, Extent extent)
    : device_(std::move(device)), extent_(extent) {}

PlanePtr PlanePool::acquire() {
  gpu::BufferPtr buffer;
  std::vector<gpu::BufferPtr> unneeded;  // freed without the lock
  {
    const std::lock_guard lock(shelf_->mutex);
    auto& buffers = shelf_->buffers;
    if (!buffers.empty()) {
      buffer = std::move(buffers.back());
      buffers.pop_back();
    }
    shelf_->unneeded = std::min(shelf_->unneeded, buffers.size());
    if (++shelf_->acquired == kTrimInterval) {
      const auto end = buffers.begin() + static_cast<ptrdiff_t>(shelf_->unneeded);
      unneeded.assign(std::make_move_iterator(buffers.begin()), std::make_move_iterator(end));
      buffers.erase(buffers.begin(), end);
      shelf_->acquired = 0;
      shelf_->unneeded = buffers.size();
    }
  }
  if (!buffer) buffer = gpu::Buffer::create_by_rows(device_, gpu::Element::vec4, extent_.pixels());
  return {new Plane{extent_, std::move(buffer)},
          [shelf = std::weak_ptr<Shelf>(shelf_)](Plane* plane) {
            if (auto alive = shelf.lock()) {
              const std::lock_guard lock(alive->mutex);
              alive->buffers.push_back(std::move(plane->buffer));
            }
            delete plane;
          }};
}

}  // namespace inverse
