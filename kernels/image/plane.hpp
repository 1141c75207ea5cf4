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

/// An image on the device: width × height vec4, row by row from the top, no padding. What the four
/// numbers mean is the business of who made it (see Layers). Reference-counted through PlanePtr:
/// who finds itself the only holder may write in place.
struct Plane {
  Extent extent;
  gpu::BufferPtr buffer;
};
using PlanePtr = std::shared_ptr<Plane>;

/// Makes planes of one size and takes them back for reuse when their last holder lets go.
/// Thread-safe; planes may outlive the pool. Reuse is safe on one device: work that still reads a
/// plane was submitted before work that overwrites it.
class PlanePool {
 public:
  PlanePool(std::shared_ptr<gpu::Device> device, Extent extent);
  /// A plane with undefined contents. Throws Error(limit) where a plane of this size does not fit
  /// the device, naming the limit, and Error(out_of_memory).
  PlanePtr acquire();
  Extent extent() const { return extent_; }

 private:
  struct Shelf {
    std::mutex mutex;
    std::vector<gpu::BufferPtr> buffers;
  };
  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

}  // namespace inverse
