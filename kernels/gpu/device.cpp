// SPDX-License-Identifier: LGPL-2.1-or-later
#include "device.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <tuple>
#include <utility>

#include "instance.hpp"
#include "kernel.hpp"
#include "variables.hpp"

namespace inverse::gpu {
namespace {

/// The family of queues to use, and how many the device has of it.
std::pair<uint32_t, uint32_t> compute_family(VkPhysicalDevice device) {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  for (uint32_t i = 0; i < count; ++i)
    if (families[i].queueFlags & VK_QUEUE_COMPUTE_BIT) return {i, families[i].queueCount};
  throw Error(ErrorKind::no_device,
              "the Vulkan device \"" + name_of(device) + "\" has no compute queue");
}

bool has_conditional(VkPhysicalDevice device) {
  if (!has_extension(device, VK_EXT_CONDITIONAL_RENDERING_EXTENSION_NAME)) return false;
  VkPhysicalDeviceConditionalRenderingFeaturesEXT conditional{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_CONDITIONAL_RENDERING_FEATURES_EXT};
  VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  features.pNext = &conditional;
  vkGetPhysicalDeviceFeatures2(device, &features);
  return conditional.conditionalRendering;
}

/// A device of our own, with the queues of one family.
struct OwnedDevice {
  struct Queue {
    VkQueue handle = VK_NULL_HANDLE;
    std::mutex mutex;  // around every use
  };

  OwnedDevice(std::shared_ptr<Instance> instance, VkPhysicalDevice physical)
      : instance(std::move(instance)), physical(physical) {
    uint32_t count = 0;
    std::tie(family, count) = compute_family(physical);
    users =
        std::max(environment_number("INVERSE_QUEUES", std::min(count, Device::kMaxQueues), 64), 1U);
    queues = std::vector<Queue>(std::min(users, count));
    const std::vector<float> priorities(queues.size(), 1.0f);
    VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queue.queueFamilyIndex = family;
    queue.queueCount = static_cast<uint32_t>(queues.size());
    queue.pQueuePriorities = priorities.data();
    VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    VkPhysicalDeviceConditionalRenderingFeaturesEXT feature{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_CONDITIONAL_RENDERING_FEATURES_EXT};
    feature.conditionalRendering = VK_TRUE;
    conditional = has_conditional(physical);
    std::vector<const char*> extensions;
    if (conditional) {
      extensions.push_back(VK_EXT_CONDITIONAL_RENDERING_EXTENSION_NAME);
      info.pNext = &feature;
    }
    // Vulkan asks for it wherever it is (VK_KHR_portability_subset is a provisional header's).
    constexpr const char* kPortability = "VK_KHR_portability_subset";
    if (has_extension(physical, kPortability)) extensions.push_back(kPortability);
    info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    check(vkCreateDevice(physical, &info, nullptr, &handle), "opening the Vulkan device");
    for (uint32_t i = 0; i < queues.size(); ++i)
      vkGetDeviceQueue(handle, family, i, &queues[i].handle);
  }
  OwnedDevice(const OwnedDevice&) = delete;
  OwnedDevice& operator=(const OwnedDevice&) = delete;
  ~OwnedDevice() {
    if (handle) vkDestroyDevice(handle, nullptr);
  }

  std::shared_ptr<Instance> instance;
  VkPhysicalDevice physical;
  VkDevice handle = VK_NULL_HANDLE;
  bool conditional = false;
  uint32_t family = 0;
  std::vector<Queue> queues;
  uint32_t users = 1;  // that are kept apart
  std::shared_ptr<std::atomic<bool>> lost = std::make_shared<std::atomic<bool>>(false);
};

/// The objects of a device, one for each user of it, up to its number of users.
struct Opened {
  std::weak_ptr<OwnedDevice> owned;
  std::vector<std::weak_ptr<Device>> objects;
  std::map<const void*, size_t> users;  // which has which
  size_t last = 0;

  /// Which one this user gets: its own, else one that nobody has, else the next in turn.
  size_t object_of(const void* user) {
    std::erase_if(users, [&](const auto& entry) { return objects[entry.second].expired(); });
    if (const auto known = users.find(user); known != users.end()) return known->second;
    const auto free = std::find_if(objects.begin(), objects.end(),
                                   [](const auto& object) { return object.expired(); });
    last = free == objects.end() ? (last + 1) % objects.size()
                                 : static_cast<size_t>(free - objects.begin());
    return users[user] = last;
  }
};

}  // namespace

void check(VkResult result, const char* what) {
  if (result >= VK_SUCCESS) return;
  const std::string text = std::string(what) + " failed: ";
  switch (result) {
    case VK_ERROR_DEVICE_LOST:
      throw Error(
          ErrorKind::device_lost,
          text + "the Vulkan device was lost (driver reset or crash); restart the pipeline");
    case VK_ERROR_OUT_OF_HOST_MEMORY:
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      throw Error(ErrorKind::out_of_memory,
                  text + "out of memory; use a smaller frame or fewer elements on this device");
    default:
      throw Error(ErrorKind::internal, text + "VkResult " + std::to_string(result));
  }
}

std::shared_ptr<Device> Device::open(const std::string& select, const void* user) {
  static std::mutex mutex;
  static std::map<size_t, Opened> all;
  std::lock_guard lock(mutex);

  std::string wanted = select;
  if (wanted.empty())
    if (const char* environment = std::getenv("INVERSE_DEVICE")) wanted = environment;
  auto instance = Instance::get();
  const auto devices = instance->devices();
  const size_t index = choose(devices, wanted);
  Opened& opened = all[index];
  auto owned = opened.owned.lock();
  if (!owned || *owned->lost) {
    owned = std::make_shared<OwnedDevice>(std::move(instance), devices[index]);
    opened = {};
    opened.owned = owned;
    opened.objects.resize(owned->users);
  }
  const size_t object = opened.object_of(user);
  if (auto device = opened.objects[object].lock()) return device;

  OwnedDevice::Queue& queue = owned->queues[object % owned->queues.size()];
  Borrowed handles{};
  handles.instance = owned->instance->handle();
  handles.physical = owned->physical;
  handles.queue_family = owned->family;
  handles.device = owned->handle;
  handles.queue = queue.handle;
  handles.lock = [&queue] { queue.mutex.lock(); };
  handles.unlock = [&queue] { queue.mutex.unlock(); };
  handles.conditional = owned->conditional;
  handles.lost = owned->lost;
  handles.owner = std::move(owned);
  std::shared_ptr<Device> device(new Device(std::move(handles), true));
  opened.objects[object] = device;
  return device;
}

std::shared_ptr<Device> Device::adopt(Borrowed borrowed) {
  return std::shared_ptr<Device>(new Device(std::move(borrowed), false));
}

Device::Device(Borrowed handles, bool owned)
    : handles_(std::move(handles)), owned_(owned), memory_(handles_.device) {
  if (!handles_.lost) handles_.lost = std::make_shared<std::atomic<bool>>(false);
  read_properties();
}

Device::~Device() {
  if (owned_) {
    handles_.lock();
    vkQueueWaitIdle(handles_.queue);
    handles_.unlock();
  }
  kernels_.clear();
}

void Device::read_properties() {
  VkPhysicalDeviceSubgroupProperties subgroup{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
  VkPhysicalDeviceProperties2 properties2{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  properties2.pNext = &subgroup;
  // Kernels of one device may have subgroups of several sizes.
  VkPhysicalDeviceSubgroupSizeControlPropertiesEXT sizes{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_PROPERTIES_EXT};
  const bool sized = has_extension(handles_.physical, VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME);
  if (sized) subgroup.pNext = &sizes;
  vkGetPhysicalDeviceProperties2(handles_.physical, &properties2);
  const VkPhysicalDeviceProperties& properties = properties2.properties;
  if (sized) limits_.min_subgroup = std::max(sizes.minSubgroupSize, limits_.min_subgroup);
  name_ = properties.deviceName;
  is_cpu_ = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  limits_.storage_buffer_bytes = properties.limits.maxStorageBufferRange;
  limits_.texel_elements = properties.limits.maxTexelBufferElements;
  limits_.window_bytes =
      std::min<uint64_t>(environment_number("INVERSE_WINDOW_BYTES", UINT32_MAX, UINT32_MAX),
                         limits_.storage_buffer_bytes);
  std::copy_n(properties.limits.maxComputeWorkGroupCount, 3, limits_.workgroups);
  limits_.line_groups = std::clamp(
      environment_number("INVERSE_LINE_GROUPS", UINT32_MAX, UINT32_MAX), 1U, limits_.workgroups[0]);
  limits_.workgroup_invocations = std::min(properties.limits.maxComputeWorkGroupInvocations,
                                           properties.limits.maxComputeWorkGroupSize[0]);

  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(handles_.physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(handles_.physical, &count, families.data());
  limits_.storage_buffers = properties.limits.maxPerStageDescriptorStorageBuffers;
  const uint32_t bits =
      handles_.queue_family < count ? families[handles_.queue_family].timestampValidBits : 0;
  if (bits > 0) limits_.timestamp_ns = properties.limits.timestampPeriod;
  limits_.timestamp_mask = bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1;
  vkGetPhysicalDeviceMemoryProperties(handles_.physical, &memory_properties_);

  // A plane of 2^24 pixels (4096 x 4096) must fit one texel view, else read storage buffers.
  // Subgroups that add must have at least `limits_.min_subgroup` invocations (SUM_PARTIALS).
  const bool arithmetic = (subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) &&
                          (subgroup.supportedOperations & VK_SUBGROUP_FEATURE_ARITHMETIC_BIT) &&
                          subgroup.subgroupSize >= limits_.min_subgroup;
  variant_.texel_views =
      limits_.texel_elements >= (1u << 24) && environment_number("INVERSE_TEXEL_VIEWS", 1) != 0;
  if (!variant_.texel_views) limits_.texel_elements = std::numeric_limits<uint64_t>::max() / 16;
  variant_.subgroups = arithmetic && environment_number("INVERSE_SUBGROUPS", 1) != 0;
  variant_.own_tables = environment_number("INVERSE_OWN_TABLES", is_cpu_) != 0;
  variant_.conditional = handles_.conditional && environment_number("INVERSE_CONDITIONAL", 1) != 0;
  variant_.warm_up = environment_number("INVERSE_WARM_UP", 1) != 0;
  variant_.time_kernels = environment_number("INVERSE_TIME_KERNELS", 0) != 0;
  variant_.padded_buffers = is_cpu_ && environment_number("INVERSE_VALIDATION", 0) == 0;
  if (variant_.conditional) {
    begin_conditional_ = reinterpret_cast<PFN_vkCmdBeginConditionalRenderingEXT>(
        vkGetDeviceProcAddr(handles_.device, "vkCmdBeginConditionalRenderingEXT"));
    end_conditional_ = reinterpret_cast<PFN_vkCmdEndConditionalRenderingEXT>(
        vkGetDeviceProcAddr(handles_.device, "vkCmdEndConditionalRenderingEXT"));
  }
  const auto lanes = [&](const char* name, uint32_t fallback) {
    return std::clamp(environment_number(name, fallback, 1024) / 8 * 8, 8u,
                      std::min(256u, limits_.workgroup_invocations));
  };
  variant_.workgroup = lanes("INVERSE_WORKGROUP", is_cpu_ ? 64 : 128);
  variant_.lone_workgroup = lanes("INVERSE_LONE_WORKGROUP", is_cpu_ ? 32 : 256);
  set_timeout(std::max(environment_number("INVERSE_TIMEOUT", is_cpu_ ? 30 : 10, 86400), 1U));
  pipeline_cache_.emplace(handles_.device, properties);
  lose_at_ = environment_number("INVERSE_LOSE_DEVICE", 0, UINT32_MAX);
}

std::shared_ptr<Kernel> Device::kernel(const KernelSource& source,
                                       const std::vector<uint32_t>& constants, uint32_t workgroup) {
  if (!workgroup) workgroup = variant_.workgroup;
  std::string key = std::string(source.name) + '/' + std::to_string(workgroup);
  for (uint32_t value : constants) key += ',' + std::to_string(value);
  Entry* entry = nullptr;
  {
    const std::lock_guard lock(kernels_mutex_);
    entry = &kernels_[key];
  }
  // Frames ask for other kernels while this one is compiled.
  std::call_once(entry->once, [&] {
    auto kernel = std::make_unique<Kernel>(*this, source, constants, workgroup);
    const std::lock_guard lock(kernels_mutex_);
    entry->kernel = std::move(kernel);
  });
  return {shared_from_this(), entry->kernel.get()};  // who holds a kernel holds the device
}

std::vector<std::shared_ptr<Kernel>> Device::unused_kernels() {
  std::vector<std::shared_ptr<Kernel>> unused;
  std::lock_guard lock(kernels_mutex_);
  for (const auto& [key, entry] : kernels_)
    if (entry.kernel && !entry.kernel->used())
      unused.emplace_back(shared_from_this(), entry.kernel.get());
  return unused;
}

void Device::count_memory(int64_t bytes) {
  const uint64_t now =
      memory_bytes_.fetch_add(static_cast<uint64_t>(bytes)) + static_cast<uint64_t>(bytes);
  uint64_t peak = memory_peak_bytes_.load();
  while (now > peak && !memory_peak_bytes_.compare_exchange_weak(peak, now)) {
  }
}

void Device::begin_conditional(VkCommandBuffer commands, VkBuffer condition,
                               uint64_t offset) const {
  VkConditionalRenderingBeginInfoEXT info{VK_STRUCTURE_TYPE_CONDITIONAL_RENDERING_BEGIN_INFO_EXT};
  info.buffer = condition;
  info.offset = offset;
  begin_conditional_(commands, &info);
}

void Device::end_conditional(VkCommandBuffer commands) const { end_conditional_(commands); }

void Device::submit(VkCommandBuffer commands, VkFence fence) {
  VkSubmitInfo info{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  info.commandBufferCount = 1;
  info.pCommandBuffers = &commands;
  // For tests: INVERSE_LOSE_DEVICE=N makes the Nth submit of the process fail as a driver would,
  // and all that follow on the same device.
  static std::atomic<uint32_t> submits{0};
  if (lose_at_ && ++submits == lose_at_) note_lost();
  if (lost()) check(VK_ERROR_DEVICE_LOST, "submitting a frame");
  handles_.lock();
  const VkResult result = vkQueueSubmit(handles_.queue, 1, &info, fence);
  handles_.unlock();
  if (result == VK_ERROR_DEVICE_LOST) note_lost();
  check(result, "submitting a frame");
}

}  // namespace inverse::gpu
