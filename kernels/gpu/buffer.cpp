// SPDX-License-Identifier: LGPL-2.1-or-later
#include "buffer.hpp"

#include <atomic>
#include <bit>
#include <string>

namespace inverse::gpu {
namespace {

VkFormat format_of(Element element) {
  switch (element) {
    case Element::vec4:
      return VK_FORMAT_R32G32B32A32_SFLOAT;
    case Element::scalar:
      return VK_FORMAT_R32_SFLOAT;
    case Element::word:
      return VK_FORMAT_R32_UINT;
  }
  return VK_FORMAT_UNDEFINED;
}

/// The memory type that suits best: of those with `required`, the one with the most of `wanted` and
/// least of the rest.
uint32_t memory_type(const Device& device, uint32_t allowed, VkMemoryPropertyFlags required,
                     VkMemoryPropertyFlags wanted) {
  const auto& properties = device.memory_properties();
  int best = -1;
  int best_score = -100;
  for (uint32_t i = 0; i < properties.memoryTypeCount; ++i) {
    const VkMemoryPropertyFlags flags = properties.memoryTypes[i].propertyFlags;
    if (!(allowed & (1u << i)) || (flags & required) != required) continue;
    const int score = 4 * __builtin_popcount(flags & wanted) - __builtin_popcount(flags & ~wanted);
    if (score > best_score) {
      best = static_cast<int>(i);
      best_score = score;
    }
  }
  if (best < 0)
    throw Error(ErrorKind::unsupported, "the Vulkan device offers no memory type for a buffer");
  return static_cast<uint32_t>(best);
}

/// Lavapipe of Mesa before 23.3 compiles a kernel again if the size of a texel buffer becomes a
/// power of two or loses bits 8 … 15, or the reverse. With some bytes more all buffers are alike.
uint64_t padded(const Device& device, uint64_t bytes) {
  constexpr uint64_t kPadding = 784;  // keeps the alignment of a vec4
  const bool alike = (bytes & 0xff00) != 0 && !std::has_single_bit(bytes);
  const bool fits = (bytes + kPadding) / 4 <= device.limits().texel_elements;
  return device.variant().padded_buffers && !alike && fits ? bytes + kPadding : bytes;
}

uint64_t next_id() {
  static std::atomic<uint64_t> last{0};
  return ++last;
}

}  // namespace

std::shared_ptr<Buffer> Buffer::create(std::shared_ptr<Device> device, Element element,
                                       uint64_t count, Memory memory) {
  const uint64_t bytes = count * element_bytes(element);
  if (const uint64_t limit = device->limits().storage_buffer_bytes; bytes > limit)
    throw Error(ErrorKind::limit, "a buffer of " + std::to_string(bytes) +
                                      " bytes exceeds maxStorageBufferRange of \"" +
                                      device->name() + "\", " + std::to_string(limit) +
                                      " bytes; use a smaller frame or another device");
  return std::shared_ptr<Buffer>(new Buffer(std::move(device), element, count ? count : 1, memory));
}

std::shared_ptr<Buffer> Buffer::create_by_rows(std::shared_ptr<Device> device, Element element,
                                               uint64_t count, Memory memory) {
  if (!device->variant().texel_views) return create(std::move(device), element, count, memory);
  return std::shared_ptr<Buffer>(new Buffer(std::move(device), element, count ? count : 1, memory));
}

Buffer::Buffer(std::shared_ptr<Device> device, Element element, uint64_t count, Memory memory)
    : device_(std::move(device)), id_(next_id()), element_(element), count_(count) {
  const Limits& limits = device_->limits();
  const bool view = device_->variant().texel_views;
  if (count_ > limits.texel_elements)
    throw Error(ErrorKind::limit, "a buffer of " + std::to_string(count_) +
                                      " elements exceeds maxTexelBufferElements of \"" +
                                      device_->name() + "\", " +
                                      std::to_string(limits.texel_elements) +
                                      "; use a smaller frame or another device");
  try {
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = padded(*device_, bytes());
    info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                 VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
    if (device_->variant().conditional) info.usage |= VK_BUFFER_USAGE_CONDITIONAL_RENDERING_BIT_EXT;
    if (view) info.usage |= VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT;
    check(vkCreateBuffer(device_->handle(), &info, nullptr, &buffer_), "creating a buffer");
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device_->handle(), buffer_, &needs);

    VkMemoryPropertyFlags required = 0;
    VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    constexpr VkMemoryPropertyFlags kMapped =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    if (memory == Memory::upload) required = wanted = kMapped;
    if (memory == Memory::readback) {
      required = kMapped;
      wanted = kMapped | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    }
    const uint32_t type = memory_type(*device_, needs.memoryTypeBits, required, wanted);
    const auto flags = device_->memory_properties().memoryTypes[type].propertyFlags;
    memory_ = device_->memory().allocate(needs, type, (flags & kMapped) == kMapped);
    device_->count_memory(static_cast<int64_t>(memory_.size));
    check(vkBindBufferMemory(device_->handle(), buffer_, memory_.memory, memory_.offset),
          "binding device memory");
    if (view) {
      VkBufferViewCreateInfo view_info{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
      view_info.buffer = buffer_;
      view_info.format = format_of(element_);
      view_info.range = VK_WHOLE_SIZE;
      check(vkCreateBufferView(device_->handle(), &view_info, nullptr, &view_),
            "creating a texel view");
    }
  } catch (...) {
    release();
    throw;
  }
}

Buffer::~Buffer() { release(); }

void Buffer::release() {
  if (view_) vkDestroyBufferView(device_->handle(), view_, nullptr);
  if (buffer_) vkDestroyBuffer(device_->handle(), buffer_, nullptr);
  if (memory_.block) {
    device_->memory().free(memory_);
    device_->count_memory(-static_cast<int64_t>(memory_.size));
  }
}

}  // namespace inverse::gpu
