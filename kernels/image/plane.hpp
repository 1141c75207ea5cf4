// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "kernels/gpu/buffer.hpp"

namespace inverse {

/// Width and height in pixels.
struct Extent {
  uint32_t width = 0, height = 0;
  bool operator==(const Extent&) const = default;
  uint64_t pixels() const { return static_cast<uint64_t>(width) * height; }
};

/// An image on the device: width × height vec4, row by row from the top, no padding. Layers::Role
/// defines the content. Reference-counted through PlanePtr: the sole owner may write in place.
struct Plane {
  Extent extent;
  gpu::BufferPtr buffer;
};
using PlanePtr = std::shared_ptr<Plane>;

/// Creates planes of one size and reuses them when their last owner releases them; those that
/// were not needed for a while are freed. Thread-safe; planes may outlive the pool. Reuse is safe
/// on one device, because pending reads of a plane were submitted before the writes that follow: an
/// owner keeps a plane until its work is submitted.
class PlanePool {
 public:
  PlanePool(std::shared_ptr<gpu::Device> device, Extent extent);
  /// A plane with undefined contents. Throws Error(out_of_memory).
  PlanePtr acquire();
  Extent extent() const { return extent_; }

  /// After so many calls of `acquire`, planes that none of them needed are freed.
  static constexpr uint32_t kTrimInterval = 32;

 private:
  struct Shelf {
    std::mutex mutex;
    std::vector<gpu::BufferPtr> buffers;
    size_t unneeded = 0;  // minimum that an `acquire` of this interval left over
    uint32_t acquired = 0;
  };
  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

}  // namespace inverse
