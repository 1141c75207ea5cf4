// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <vulkan/vulkan.h>

#include <cstddef>
#include <cstdint>
#include <memory>

#include "device.hpp"
#include "kernel_source.hpp"
#include "memory.hpp"

namespace inverse::gpu {

constexpr size_t element_bytes(Element e) { return e == Element::vec4 ? 16 : 4; }

/// Where a buffer lives. On devices without memory of their own (lavapipe) all three are the same
/// mapped memory.
enum class Memory : uint8_t {
  device,    ///< fast for kernels; `map()` is null on discrete devices
  upload,    ///< the host writes, kernels read
  readback,  ///< kernels write, the host reads (cached)
};

/// A buffer on the device with its texel view. Kernels read it through the view (without
/// Variant::texel_views as a storage buffer) and write it as a storage buffer. Not zeroed: use
/// Commands::fill.
class Buffer {
 public:
  /// `count` elements, at least one. Throws Error(limit) if the device cannot bind so large a
  /// buffer, naming the limit, and Error(out_of_memory).
  static std::shared_ptr<Buffer> create(std::shared_ptr<Device> device, Element element,
                                        uint64_t count, Memory memory = Memory::device);
  /// As `create`, for kernels that write it by rows: only its texel view limits it, without
  /// Variant::texel_views what a kernel can bind.
  static std::shared_ptr<Buffer> create_by_rows(std::shared_ptr<Device> device, Element element,
                                                uint64_t count, Memory memory = Memory::device);
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  ~Buffer();

  Element element() const { return element_; }
  uint64_t count() const { return count_; }
  uint64_t bytes() const { return count_ * element_bytes(element_); }
  /// The buffer in host memory, or null if it is not mapped. Coherent: no flushes. Writes are
  /// seen by work that is submitted later; reads see work whose Commands::wait has returned.
  void* map() const { return memory_.mapped; }
  template <typename T>
  T* map_as() const {
    return static_cast<T*>(memory_.mapped);
  }
  const std::shared_ptr<Device>& device() const { return device_; }

  /// A number that no other buffer of the process has.
  uint64_t id() const { return id_; }
  VkBuffer handle() const { return buffer_; }
  VkBufferView view() const { return view_; }

 private:
  Buffer(std::shared_ptr<Device> device, Element element, uint64_t count, Memory memory);
  void release();

  std::shared_ptr<Device> device_;
  uint64_t id_;
  Element element_;
  uint64_t count_;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  MemoryBlocks::Piece memory_;
  VkBufferView view_ = VK_NULL_HANDLE;
};

using BufferPtr = std::shared_ptr<Buffer>;

}  // namespace inverse::gpu
