// SPDX-License-Identifier: LGPL-2.1-or-later
#include "memory.hpp"

#include <algorithm>
#include <iterator>
#include <optional>

#include "device.hpp"

namespace inverse::gpu {
namespace {

/// Takes an aligned part out of what is free, the first that is large enough.
std::optional<VkDeviceSize> take(std::map<VkDeviceSize, VkDeviceSize>& free,
                                 const VkMemoryRequirements& needs) {
  for (auto range = free.begin(); range != free.end(); ++range) {
    const auto [begin, size] = *range;
    const VkDeviceSize end = begin + size;
    const VkDeviceSize at = (begin + needs.alignment - 1) / needs.alignment * needs.alignment;
    if (at + needs.size > end) continue;
    free.erase(range);
    if (at > begin) free[begin] = at - begin;
    if (at + needs.size < end) free[at + needs.size] = end - at - needs.size;
    return at;
  }
  return {};
}

/// Returns a part to what is free, joined with its neighbors.
void put_back(std::map<VkDeviceSize, VkDeviceSize>& free, VkDeviceSize offset, VkDeviceSize size) {
  auto here = free.emplace(offset, size).first;
  if (const auto next = std::next(here); next != free.end() && offset + size == next->first) {
    here->second += next->second;
    free.erase(next);
  }
  if (here == free.begin()) return;
  if (const auto before = std::prev(here); before->first + before->second == offset) {
    before->second += here->second;
    free.erase(here);
  }
}

/// Whether no buffer is in a block that they share.
bool is_free(const MemoryBlocks::Block& block) {
  return !block.free.empty() && block.free.begin()->second == block.size;
}

}  // namespace

MemoryBlocks::~MemoryBlocks() {
  for (const Block& block : blocks_) vkFreeMemory(device_, block.memory, nullptr);
}

MemoryBlocks::Block& MemoryBlocks::add_block(VkDeviceSize size, uint32_t type, bool host_visible) {
  Block block{.size = size, .type = type};
  VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  info.allocationSize = size;
  info.memoryTypeIndex = type;
  check(vkAllocateMemory(device_, &info, nullptr, &block.memory), "allocating device memory");
  if (host_visible) {
    const VkResult mapped = vkMapMemory(device_, block.memory, 0, VK_WHOLE_SIZE, 0, &block.mapped);
    if (mapped != VK_SUCCESS) vkFreeMemory(device_, block.memory, nullptr);
    check(mapped, "mapping device memory");
  }
  return blocks_.emplace_back(std::move(block));
}

MemoryBlocks::Piece MemoryBlocks::allocate(const VkMemoryRequirements& needs, uint32_t type,
                                           bool host_visible) {
  const std::lock_guard lock(mutex_);
  const auto piece_at = [&](Block& block, VkDeviceSize offset) {
    void* mapped = block.mapped ? static_cast<char*>(block.mapped) + offset : nullptr;
    return Piece{&block, block.memory, offset, needs.size, mapped};
  };
  if (needs.size >= kOwn) return piece_at(add_block(needs.size, type, host_visible), 0);
  for (Block& block : blocks_)
    if (block.type == type)
      if (const auto offset = take(block.free, needs)) return piece_at(block, *offset);
  Block& block = add_block(kBlock, type, host_visible);
  block.free[0] = kBlock;
  return piece_at(block, *take(block.free, needs));
}

void MemoryBlocks::free(const Piece& piece) {
  const std::lock_guard lock(mutex_);
  Block& block = *piece.block;
  if (piece.size < kOwn) {
    put_back(block.free, piece.offset, piece.size);
    if (!is_free(block)) return;
    const bool spare = std::any_of(blocks_.begin(), blocks_.end(), [&](const Block& other) {
      return &other != &block && other.type == block.type && is_free(other);
    });
    if (!spare) return;
  }
  vkFreeMemory(device_, block.memory, nullptr);
  blocks_.remove_if([&](const Block& other) { return &other == &block; });
}

size_t MemoryBlocks::allocations() const {
  const std::lock_guard lock(mutex_);
  return blocks_.size();
}

}  // namespace inverse::gpu
