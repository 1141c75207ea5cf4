// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pipeline_cache.hpp"

#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "common/open_file.hpp"
#include "device.hpp"

namespace inverse::gpu {
namespace {

namespace fs = std::filesystem;
constexpr uint64_t kLargest = uint64_t{256} << 20;  // bytes of a file that is read

fs::path folder_for(const VkPhysicalDeviceProperties& properties) {
  if (const char* named = std::getenv("INVERSE_PIPELINE_CACHE")) return named;
  if (properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU) return {};
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache == '/')
    return fs::path(cache) / "gst-inverse";
  if (const char* home = std::getenv("HOME"); home && *home == '/')
    return fs::path(home) / ".cache/gst-inverse";
  return {};
}

std::string name_for(const VkPhysicalDeviceProperties& properties) {
  std::string name = "kernels-";
  for (const uint8_t byte : properties.pipelineCacheUUID) {
    constexpr const char* kDigits = "0123456789abcdef";
    name += {kDigits[byte >> 4U], kDigits[byte & 15U]};
  }
  return name + ".bin";
}

/// Whether a driver of this device wrote the data (Vulkan 1.1, VkPipelineCacheHeaderVersionOne).
/// Drivers check it, too, but not all of them well.
bool suits(const std::string& data, const VkPhysicalDeviceProperties& properties) {
  struct Header {
    uint32_t size, version, vendor, device;
    uint8_t uuid[VK_UUID_SIZE];
  } header;
  if (data.size() < sizeof header) return false;
  std::memcpy(&header, data.data(), sizeof header);
  return header.size >= sizeof header && header.size <= data.size() &&
         header.version == VK_PIPELINE_CACHE_HEADER_VERSION_ONE &&
         header.vendor == properties.vendorID && header.device == properties.deviceID &&
         !std::memcmp(header.uuid, properties.pipelineCacheUUID, VK_UUID_SIZE);
}

}  // namespace

PipelineCache::PipelineCache(VkDevice device, const VkPhysicalDeviceProperties& properties)
    : device_(device), properties_(properties) {
  if (const fs::path in = folder_for(properties); !in.empty()) file_ = in / name_for(properties);
  const std::string data = read_data();
  read_ = data.size();
  VkPipelineCacheCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  info.initialDataSize = data.size();
  info.pInitialData = data.data();
  check(vkCreatePipelineCache(device_, &info, nullptr, &cache_), "creating a pipeline cache");
}

std::string PipelineCache::read_data() const {
  if (file_.empty()) return {};
  std::string fault;  // such a file is ignored
  std::string data = read_file(file_.string(), kLargest, fault);
  return suits(data, properties_) ? data : std::string();
}

PipelineCache::~PipelineCache() {
  if (!file_.empty()) save();
  vkDestroyPipelineCache(device_, cache_, nullptr);
}

/// Adds the kernels that other devices of the process, or other processes, have written meanwhile.
void PipelineCache::merge_file() const {
  const std::string data = read_data();
  if (data.size() <= read_) return;
  VkPipelineCacheCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  info.initialDataSize = data.size();
  info.pInitialData = data.data();
  VkPipelineCache written = VK_NULL_HANDLE;
  if (vkCreatePipelineCache(device_, &info, nullptr, &written) != VK_SUCCESS) return;
  vkMergePipelineCaches(device_, cache_, 1, &written);
  vkDestroyPipelineCache(device_, written, nullptr);
}

void PipelineCache::save() const {
  size_t size = 0;
  if (vkGetPipelineCacheData(device_, cache_, &size, nullptr) != VK_SUCCESS || size <= read_)
    return;
  merge_file();
  if (vkGetPipelineCacheData(device_, cache_, &size, nullptr) != VK_SUCCESS) return;
  std::vector<char> data(size);
  if (vkGetPipelineCacheData(device_, cache_, &size, data.data()) != VK_SUCCESS) return;
  // Renamed when complete: other processes never read half a file.
  std::error_code error;
  fs::create_directories(file_.parent_path(), error);
  std::string made = file_.string() + ".XXXXXX";
  const int descriptor = mkstemp(made.data());
  if (descriptor < 0) return;
  const bool whole = write(descriptor, data.data(), size) == static_cast<ssize_t>(size);
  close(descriptor);
  if (whole) fs::rename(made, file_, error);
  if (!whole || error) fs::remove(made, error);
}

}  // namespace inverse::gpu
