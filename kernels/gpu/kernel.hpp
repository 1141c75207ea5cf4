// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <vulkan/vulkan.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "binding.hpp"
#include "device.hpp"

namespace inverse::gpu {

inline VkDescriptorType descriptor_type(const Slot& slot) {
  return slot.texel ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

/// A compute pipeline with its layout. Made and owned by Device::kernel.
class Kernel {
 public:
  Kernel(const Device& device, const KernelSource& source, const std::vector<uint32_t>& constants,
         uint32_t workgroup);
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;
  ~Kernel();

  const char* name() const { return name_; }
  uint32_t workgroup() const { return workgroup_; }
  std::span<const Slot> slots() const { return slots_; }
  /// True for the first caller only.
  bool first_use() { return !used_.exchange(true); }
  bool used() const { return used_; }
  VkPipeline pipeline() const { return pipeline_; }
  VkPipelineLayout layout() const { return layout_; }
  VkDescriptorSetLayout set_layout() const { return set_layout_; }

  static constexpr uint32_t kPushBytes = 128;

 private:
  void release();

  const Device& device_;
  const char* name_;
  uint32_t workgroup_;
  std::span<const Slot> slots_;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  std::atomic<bool> used_{false};
};

using KernelPtr = std::shared_ptr<Kernel>;

/// The kernel of a shader of which the build made `Shader` (embed.py), so that it is called by
/// names: `Program<shaders::palette_merge>`.
template <typename Shader>
class Program {
 public:
  Program() = default;
  /// As Device::kernel.
  Program(const std::shared_ptr<Device>& device, const typename Shader::Constants& constants = {},
          uint32_t workgroup = 0)
      : kernel_(device->kernel(Shader::source, constants.all(), workgroup)) {}
  const KernelPtr& kernel() const { return kernel_; }

 private:
  KernelPtr kernel_;
};

}  // namespace inverse::gpu
