// SPDX-License-Identifier: LGPL-2.1-or-later
#include "descriptor_sets.hpp"

namespace inverse::gpu {

DescriptorSets::~DescriptorSets() {
  for (VkDescriptorPool pool : pools_) vkDestroyDescriptorPool(device_->handle(), pool, nullptr);
}

void DescriptorSets::begin() {
  for (auto& [layout, of_layout] : layouts_) of_layout.used = 0;
}

VkDescriptorSet DescriptorSets::get(const Kernel& kernel, std::span<const Bound> bound) {
  Set& set = next(kernel.set_layout());
  std::array<Written, kMaxBindings> wanted{};
  for (size_t i = 0; i < bound.size(); ++i)
    wanted[i] = {bound[i].buffer->id(), bound[i].offset, bound[i].bytes};
  if (set.written == wanted) return set.handle;
  const auto slots = kernel.slots();
  VkDescriptorBufferInfo infos[kMaxBindings];
  VkBufferView views[kMaxBindings];
  VkWriteDescriptorSet writes[kMaxBindings];
  for (uint32_t i = 0; i < bound.size(); ++i) {
    infos[i] = {bound[i].buffer->handle(), bound[i].offset, bound[i].bytes};
    views[i] = bound[i].buffer->view();
    writes[i] = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    writes[i].dstSet = set.handle;
    writes[i].dstBinding = i;
    writes[i].descriptorCount = 1;
    writes[i].descriptorType = descriptor_type(slots[i]);
    writes[i].pBufferInfo = &infos[i];
    writes[i].pTexelBufferView = &views[i];
  }
  vkUpdateDescriptorSets(device_->handle(), static_cast<uint32_t>(bound.size()), writes, 0,
                         nullptr);
  set.written = wanted;
  return set.handle;
}

DescriptorSets::Set& DescriptorSets::next(VkDescriptorSetLayout layout) {
  OfLayout& of_layout = layouts_[layout];
  if (of_layout.used == of_layout.sets.size()) of_layout.sets.push_back({allocate(layout), {}});
  return of_layout.sets[of_layout.used++];
}

VkDescriptorSet DescriptorSets::allocate(VkDescriptorSetLayout layout) {
  constexpr uint32_t kSetsPerPool = 128;
  VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  VkDescriptorSet set = VK_NULL_HANDLE;
  if (!pools_.empty()) {
    info.descriptorPool = pools_.back();
    const VkResult result = vkAllocateDescriptorSets(device_->handle(), &info, &set);
    if (result == VK_SUCCESS) return set;
    if (result != VK_ERROR_OUT_OF_POOL_MEMORY && result != VK_ERROR_FRAGMENTED_POOL)
      check(result, "allocating descriptors");
  }
  const VkDescriptorPoolSize sizes[] = {
      {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kSetsPerPool * kMaxBindings},
      {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, kSetsPerPool * kMaxBindings},
  };
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.maxSets = kSetsPerPool;
  pool.poolSizeCount = 2;
  pool.pPoolSizes = sizes;
  check(vkCreateDescriptorPool(device_->handle(), &pool, nullptr, &info.descriptorPool),
        "creating a descriptor pool");
  pools_.push_back(info.descriptorPool);
  check(vkAllocateDescriptorSets(device_->handle(), &info, &set), "allocating descriptors");
  return set;
}

}  // namespace inverse::gpu
