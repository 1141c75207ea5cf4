// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pipeline_cache.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "common/checksum.hpp"
#include "common/open_file.hpp"
#include "device.hpp"

namespace inverse::gpu {
namespace {

namespace fs = std::filesystem;
constexpr uint64_t kLargest = uint64_t{256} << 20;              // bytes of a file that is read
constexpr std::string_view kMagic = "gst-inverse kernels 1\n";  // then a checksum, and the data

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

/// What processes that were killed left beside a file.
void remove_drafts(const fs::path& file) {
  constexpr auto kOld = std::chrono::hours(1);
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(file.parent_path(), none))
    if (entry.path().filename().string().starts_with(file.filename().string() + ".") &&
        fs::file_time_type::clock::now() - entry.last_write_time(none) > kOld)
      fs::remove(entry.path(), none);
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
  // Drivers parse the data: what somebody else may have written, or what is damaged, is ignored.
  const OpenFile file(file_.string());
  std::string fault;
  std::string data = file.own() ? read_file(file, kLargest, fault) : std::string();
  uint64_t sum = 0;
  if (data.size() < kMagic.size() + sizeof sum || !data.starts_with(kMagic)) return {};
  std::memcpy(&sum, data.data() + kMagic.size(), sizeof sum);
  data.erase(0, kMagic.size() + sizeof sum);
  return checksum(data) == sum && suits(data, properties_) ? data : std::string();
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
  std::string data(size, '\0');
  if (vkGetPipelineCacheData(device_, cache_, &size, data.data()) != VK_SUCCESS) return;
  data.resize(size);
  const uint64_t sum = checksum(data);
  data.insert(0, kMagic).insert(kMagic.size(), reinterpret_cast<const char*>(&sum), sizeof sum);
  // Renamed when complete: other processes never read half a file.
  std::error_code error;
  fs::create_directories(file_.parent_path(), error);
  remove_drafts(file_);
  std::string made = file_.string() + ".XXXXXX";
  const int descriptor = mkstemp(made.data());
  if (descriptor < 0) return;
  const bool whole =
      write(descriptor, data.data(), data.size()) == static_cast<ssize_t>(data.size());
  close(descriptor);
  if (whole) fs::rename(made, file_, error);
  if (!whole || error) fs::remove(made, error);
}

}  // namespace inverse::gpu
