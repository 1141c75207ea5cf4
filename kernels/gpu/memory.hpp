// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <vulkan/vulkan.h>

#include <cstdint>
#include <list>
#include <map>
#include <mutex>

namespace inverse::gpu {

/// Memory of a device for buffers. Drivers allow few allocations (maxMemoryAllocationCount, 4096 is
/// usual), so that small buffers share blocks. Those of kOwn bytes and more have an allocation of
/// their own, which returns to the driver with them. A block that is free is kept, one of each
/// type, because drivers take milliseconds for one. Thread-safe.
class MemoryBlocks {
 public:
  struct Block;
  /// A part of a block, or all of one; mapped if the memory can be.
  struct Piece {
    Block* block = nullptr;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkDeviceSize offset = 0, size = 0;
    void* mapped = nullptr;
  };

  explicit MemoryBlocks(VkDevice device) : device_(device) {}
  MemoryBlocks(const MemoryBlocks&) = delete;
  MemoryBlocks& operator=(const MemoryBlocks&) = delete;
  ~MemoryBlocks();

  /// Memory of a type, mapped if it is `host_visible`. Throws Error(out_of_memory).
  Piece allocate(const VkMemoryRequirements& needs, uint32_t type, bool host_visible);
  void free(const Piece& piece);
  /// Allocations from the driver.
  size_t allocations() const;

  static constexpr VkDeviceSize kOwn = VkDeviceSize{4} << 20, kBlock = VkDeviceSize{32} << 20;

 private:
  Block& add_block(VkDeviceSize size, uint32_t type, bool host_visible);

  VkDevice device_;
  mutable std::mutex mutex_;
  std::list<Block> blocks_;
};

struct MemoryBlocks::Block {
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkDeviceSize size = 0;
  uint32_t type = 0;
  void* mapped = nullptr;
  std::map<VkDeviceSize, VkDeviceSize> free{};  // what is free: its offset and size
};

}  // namespace inverse::gpu
