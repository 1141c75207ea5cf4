// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <vulkan/vulkan.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "buffer.hpp"
#include "kernel.hpp"

namespace inverse::gpu {

/// The descriptor sets of one recording after another. A recording takes the sets of each layout in
/// the same order as the one before; because frames are alike, they mostly hold what they should.
class DescriptorSets {
 public:
  static constexpr uint32_t kMaxBindings = 14;

  /// The part of a buffer that a kernel sees.
  struct Bound {
    const Buffer* buffer = nullptr;
    uint64_t offset = 0, bytes = 0;
  };

  explicit DescriptorSets(std::shared_ptr<Device> device) : device_(std::move(device)) {}
  DescriptorSets(const DescriptorSets&) = delete;
  DescriptorSets& operator=(const DescriptorSets&) = delete;
  ~DescriptorSets();

  /// Starts a recording. The device has to be done with the one before.
  void begin();
  /// A set of the kernel's layout with these parts of buffers, one for each of its slots.
  VkDescriptorSet get(const Kernel& kernel, std::span<const Bound> bound);

 private:
  /// What a set holds; buffers by their id, because another may have the handle of a freed one.
  struct Written {
    uint64_t id = 0, offset = 0, bytes = 0;
    bool operator==(const Written&) const = default;
  };
  struct Set {
    VkDescriptorSet handle = VK_NULL_HANDLE;
    std::array<Written, kMaxBindings> written{};
  };
  struct OfLayout {
    std::vector<Set> sets;
    size_t used = 0;  // by this recording
  };

  Set& next(VkDescriptorSetLayout layout);
  VkDescriptorSet allocate(VkDescriptorSetLayout layout);

  std::shared_ptr<Device> device_;
  std::vector<VkDescriptorPool> pools_;
  std::unordered_map<VkDescriptorSetLayout, OfLayout> layouts_;
};

}  // namespace inverse::gpu
