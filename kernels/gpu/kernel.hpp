// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <vulkan/vulkan.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "binding.hpp"
#include "device.hpp"

namespace inverse::gpu {

inline VkDescriptorType descriptor_type(const Slot& slot) {
  return slot.texel ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

/// How many invocations a dispatch needs; x is rounded up to whole workgroups (kernels check the
/// remainder).
struct Items {
  /// A line, of any length: kernels read line_index (common.glsl).
  constexpr Items(uint32_t count = 1) : x(count), line(true) {}
  constexpr Items(uint32_t width, uint32_t height, uint32_t depth = 1)
      : x(width), y(height), z(depth) {}
  uint32_t x = 1, y = 1, z = 1;
  bool line = false;
};

/// Items that work on rows of a picture from `first_row`, a push constant of the shader, on:
/// Commands dispatches them in parts if what they write does not fit a binding (by_rows).
struct Rows {
  uint32_t width = 1;         ///< items along a row
  uint32_t rows = 1;          ///< of the picture
  uint32_t rows_an_item = 1;  ///< a power of two up to 64
  bool line = false;          ///< dispatched as a line: the shader reads line_index
  uint32_t begin = 0;  ///< the first row to work on; up to kStep - 1 before it are dispatched
  uint32_t end = UINT32_MAX;  ///< the row after the last one to work on, at most `rows`
  /// Parts begin at multiples of it, which suits items and the alignment of bindings.
  static constexpr uint32_t kStep = 64;
};

/// `groups` workgroups along x as rows of at most `limit` along y: {x, y} with the minimum
/// number of rows and less than one row too many.
constexpr std::pair<uint32_t, uint32_t> rows_of_groups(uint32_t groups, uint32_t limit) {
  const uint32_t rows = groups > 0 ? (groups - 1) / limit + 1 : 1;
  return {groups / rows + (groups % rows > 0), rows};
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
  /// Most groups of a workgroup that add a partial sum each: subgroups, or the whole one.
  uint32_t max_subgroups() const;
  std::span<const Slot> slots() const { return slots_; }
  /// Workgroups for `items`, none of which is 0: a line goes on along y if the device does not
  /// allow so many along x. Throws Error(limit) if it still does not.
  Items groups(Items items) const;
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
