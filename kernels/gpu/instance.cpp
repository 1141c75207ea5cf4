// SPDX-License-Identifier: LGPL-2.1-or-later
#include "instance.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>

#include "common/error.hpp"
#include "variables.hpp"

namespace inverse::gpu {
namespace {

/// Under INVERSE_VALIDATION=1 a misuse of Vulkan ends the process where it happens, so that no test
/// can miss it.
VKAPI_ATTR VkBool32 VKAPI_CALL abort_on_misuse(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                               VkDebugUtilsMessageTypeFlagsEXT,
                                               const VkDebugUtilsMessengerCallbackDataEXT* message,
                                               void*) {
  std::fprintf(stderr, "Vulkan validation: %s\n", message->pMessage);
  std::abort();
}

bool lists(const std::vector<VkExtensionProperties>& all, const char* name) {
  return std::any_of(all.begin(), all.end(), [&](const VkExtensionProperties& extension) {
    return !std::strcmp(extension.extensionName, name);
  });
}

std::vector<VkExtensionProperties> instance_extensions() {
  uint32_t count = 0;
  vkEnumerateInstanceExtensionProperties(nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> all(count);
  vkEnumerateInstanceExtensionProperties(nullptr, &count, all.data());
  return all;
}

int rank_of(VkPhysicalDevice device) {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(device, &properties);
  switch (properties.deviceType) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 0;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 1;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 2;
    default:
      return 3;
  }
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool validates() { return environment_number("INVERSE_VALIDATION", 0) != 0; }

}  // namespace

std::shared_ptr<Instance> Instance::get() {
  static std::mutex mutex;
  static auto* const kept = new std::shared_ptr<Instance>;  // not destroyed while drivers are
  std::lock_guard lock(mutex);
  if (!*kept || (validates() && !(*kept)->messenger_)) *kept = std::make_shared<Instance>();
  return *kept;
}

Instance::Instance() {
  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "gst-inverse";
  application.apiVersion = VK_API_VERSION_1_1;
  const char* layer = "VK_LAYER_KHRONOS_validation";
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pApplicationInfo = &application;
  VkDebugUtilsMessengerCreateInfoEXT messenger{
      VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  messenger.pfnUserCallback = abort_on_misuse;
  const bool validating = validates();
  // Missing barriers are misuse, too.
  const auto synchronization = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = &synchronization;
  std::vector<const char*> extensions;
  if (validating) {
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &layer;
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
    messenger.pNext = &features;
    info.pNext = &messenger;
  }
  // Devices that do not have all of Vulkan (MoltenVK) are hidden without it.
  if (lists(instance_extensions(), VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME)) {
    extensions.push_back(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
    info.flags |= VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR;
  }
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  const VkResult result = vkCreateInstance(&info, nullptr, &handle_);
  if (result == VK_ERROR_LAYER_NOT_PRESENT)
    throw Error(ErrorKind::no_device,
                "INVERSE_VALIDATION=1 asks for the Vulkan validation layer, which is not installed "
                "(Debian: vulkan-validationlayers)");
  if (result == VK_ERROR_EXTENSION_NOT_PRESENT && validating)
    throw Error(ErrorKind::no_device,
                "INVERSE_VALIDATION=1 asks for a Vulkan validation layer that has "
                "VK_EXT_validation_features; install a newer one");
  if (result != VK_SUCCESS)
    throw Error(
        ErrorKind::no_device,
        "no Vulkan driver could be loaded; install one (Debian: mesa-vulkan-drivers) or check "
        "VK_ICD_FILENAMES; VK_LOADER_DEBUG=all prints what was tried");
  if (validating) {
    // The one above gets messages about the instance itself, this one all others.
    const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(handle_, "vkCreateDebugUtilsMessengerEXT"));
    messenger.pNext = nullptr;
    create(handle_, &messenger, nullptr, &messenger_);
  }
}

Instance::~Instance() {
  if (messenger_)
    reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(
        handle_, "vkDestroyDebugUtilsMessengerEXT"))(handle_, messenger_, nullptr);
  vkDestroyInstance(handle_, nullptr);
}

std::vector<VkPhysicalDevice> Instance::devices() const {
  uint32_t count = 0;
  vkEnumeratePhysicalDevices(handle_, &count, nullptr);
  std::vector<VkPhysicalDevice> all(count);
  if (count) vkEnumeratePhysicalDevices(handle_, &count, all.data());
  all.resize(count);
  std::erase_if(all, [](VkPhysicalDevice device) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(device, &properties);
    return properties.apiVersion < VK_API_VERSION_1_1;
  });
  return all;
}

bool has_extension(VkPhysicalDevice device, const char* name) {
  uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> all(count);
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, all.data());
  return lists(all, name);
}

std::string name_of(VkPhysicalDevice device) {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(device, &properties);
  return properties.deviceName;
}

size_t choose(const std::vector<VkPhysicalDevice>& devices, const std::string& select) {
  if (devices.empty())
    throw Error(
        ErrorKind::no_device,
        "no device with Vulkan 1.1 found; install a driver (Debian: mesa-vulkan-drivers brings the "
        "software device "
        "lavapipe) or check VK_ICD_FILENAMES");
  if (select.empty()) {
    size_t best = 0;
    for (size_t i = 1; i < devices.size(); ++i)
      if (rank_of(devices[i]) < rank_of(devices[best])) best = i;
    return best;
  }
  if (std::all_of(select.begin(), select.end(), [](unsigned char c) { return std::isdigit(c); }) &&
      select.size() < 4) {
    const size_t index = std::stoul(select);
    if (index < devices.size()) return index;
  } else {
    for (size_t i = 0; i < devices.size(); ++i)
      if (lower(name_of(devices[i])).find(lower(select)) != std::string::npos) return i;
  }
  std::string names;
  for (size_t i = 0; i < devices.size(); ++i)
    names += (i ? ", " : "") + std::to_string(i) + " = \"" + name_of(devices[i]) + "\"";
  throw Error(ErrorKind::no_device,
              "no Vulkan device matches \"" + select + "\"; there are: " + names);
}

}  // namespace inverse::gpu
