// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <vulkan/vulkan.h>

#include <filesystem>
#include <string>

namespace inverse::gpu {

/// Compiled kernels of a device, kept in a file between runs for drivers that keep none themselves:
/// `gst-inverse/kernels-<UUID>.bin` in `$XDG_CACHE_HOME` or `~/.cache`, none for software devices,
/// for which Mesa does that. `INVERSE_PIPELINE_CACHE` names another folder; empty: no file. A file
/// that cannot be read or written, is damaged, or that others may write to is ignored: kernels are
/// compiled again.
class PipelineCache {
 public:
  PipelineCache(VkDevice device, const VkPhysicalDeviceProperties& properties);
  PipelineCache(const PipelineCache&) = delete;
  PipelineCache& operator=(const PipelineCache&) = delete;
  /// Writes the file if kernels came to it.
  ~PipelineCache();
  VkPipelineCache handle() const { return cache_; }

 private:
  /// What the file has; empty if that is not of this device and driver.
  std::string read_data() const;
  void merge_file() const;
  void save() const;

  VkDevice device_;
  VkPhysicalDeviceProperties properties_;
  VkPipelineCache cache_ = VK_NULL_HANDLE;
  std::filesystem::path file_;  // empty: none
  size_t read_ = 0;             // bytes that the file had
};

}  // namespace inverse::gpu
