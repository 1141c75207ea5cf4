// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <vulkan/vulkan.h>

#include <memory>
#include <string>
#include <vector>

namespace inverse::gpu {

/// The process' Vulkan instance: one is enough, and making one costs tens of milliseconds. It is
/// kept until the process ends, because a driver that is loaded again and again fails at last
/// (NVIDIA 580, after some thirty times).
class Instance {
 public:
  /// The instance, made by the first call. Throws Error(no_device).
  static std::shared_ptr<Instance> get();

  Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;
  ~Instance();

  VkInstance handle() const { return handle_; }
  /// Those that have Vulkan 1.1.
  std::vector<VkPhysicalDevice> devices() const;

 private:
  VkInstance handle_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

/// The index of the device that `select` means (Device::open). Throws Error(no_device).
size_t choose(const std::vector<VkPhysicalDevice>& devices, const std::string& select);

std::string name_of(VkPhysicalDevice device);
bool has_extension(VkPhysicalDevice device, const char* name);

}  // namespace inverse::gpu
