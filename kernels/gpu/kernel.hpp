#pragma once
#include <vulkan/vulkan.h>

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "device.hpp"
#include "kernel_source.hpp"

namespace inverse::gpu {

/// What a shader declares at one binding; read from the SPIR-V, so that C++ never repeats it.
struct Slot {
  VkDescriptorType type;
  bool reads;
  bool writes;
};

/// Reads the bindings of set 0 from SPIR-V; index = binding. Throws Error(internal) on gaps or
/// unknown resources.
std::vector<Slot> reflect_slots(std::span<const uint32_t> spirv, const char* name);

/// A float as a specialization constant.
inline uint32_t constant(float value) { return std::bit_cast<uint32_t>(value); }

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
  const std::vector<Slot>& slots() const { return slots_; }
  /// True for the first caller only.
  bool first_use() { return !used_.exchange(true); }
  VkPipeline pipeline() const { return pipeline_; }
  VkPipelineLayout layout() const { return layout_; }
  VkDescriptorSetLayout set_layout() const { return set_layout_; }

  static constexpr uint32_t kPushBytes = 128;

 private:
  void release();

  const Device& device_;
  const char* name_;
  uint32_t workgroup_;
  std::vector<Slot> slots_;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  std::atomic<bool> used_{false};
};

using KernelPtr = std::shared_ptr<Kernel>;

}  // namespace inverse::gpu
