// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vulkan_bridge.hpp"

#include <algorithm>
#include <cstring>
#include <list>
#include <string>
#include <vector>

#include "vulkan_bridge_detail.hpp"

namespace inverse {
namespace {

using DevicePtr = std::shared_ptr<gpu::Device>;

using bridge::add_ref;
using bridge::DeviceRef;
using bridge::Handles;
using bridge::InstanceRef;
using bridge::QueueRef;
using HandlesPtr = std::shared_ptr<Handles>;

/// Which GstVulkanDevice is wrapped by which gpu::Device: planes can only be shared between
/// elements that hold the same object.
class Registry {
 public:
  static Registry& get() {
    static Registry registry;
    return registry;
  }

  /// The wrapped device; `queue` is where the neighbors submit, or null if unknown.
  DevicePtr adopt(GstVulkanDevice* device, GstVulkanQueue* queue) {
    std::lock_guard lock(mutex_);
    std::erase_if(entries_, [](const Entry& entry) { return entry.device.expired(); });
    for (const Entry& entry : entries_)
      if (auto known = entry.device.lock(); known && entry.raw == device) return known;
    auto handles = std::make_shared<Handles>();
    handles->device.reset(add_ref(device));
    handles->queue = queue ? QueueRef(add_ref(queue)) : first_queue(device);
    check(*handles);
    GstVulkanQueue* submits = handles->queue.get();
    auto wrapped = gpu::Device::adopt(
        {device->instance->instance, gst_vulkan_device_get_physical_device(device), device->device,
         submits->family, submits->queue, [submits] { gst_vulkan_queue_submit_lock(submits); },
         [submits] { gst_vulkan_queue_submit_unlock(submits); }, handles});
    entries_.push_back({device, handles, wrapped});
    return wrapped;
  }

  /// Null if GStreamer did not make the device.
  HandlesPtr handles_of(const gpu::Device& device) {
    std::lock_guard lock(mutex_);
    for (const Entry& entry : entries_)
      if (entry.device.lock().get() == &device) return entry.handles.lock();
    return nullptr;
  }

 private:
  struct Entry {
    GstVulkanDevice* raw;
    std::weak_ptr<Handles> handles;
    std::weak_ptr<gpu::Device> device;
  };

  static QueueRef first_queue(GstVulkanDevice* device) {
    GstVulkanQueue* first = nullptr;
    const auto take = [](GstVulkanDevice*, GstVulkanQueue* queue, gpointer to) -> gboolean {
      *static_cast<GstVulkanQueue**>(to) = add_ref(queue);
      return FALSE;
    };
    gst_vulkan_device_foreach_queue(device, take, &first);
    return QueueRef(first);
  }

  /// Kernels are SPIR-V 1.3 and run on the queue that images come and go on.
  static void check(const Handles& handles) {
    const GstVulkanPhysicalDevice* physical = handles.device->physical_device;
    const std::string name = physical->properties.deviceName;
    if (!gst_vulkan_instance_check_version(handles.device->instance, 1, 1, 0) ||
        physical->properties.apiVersion < VK_API_VERSION_1_1)
      throw Error(ErrorKind::no_device,
                  "the Vulkan device \"" + name +
                      "\" that neighboring elements use has no Vulkan 1.1, which is needed; "
                      "choose another driver or put vulkandownload before this element");
    if (!handles.queue ||
        !(physical->queue_family_props[handles.queue->family].queueFlags & VK_QUEUE_COMPUTE_BIT))
      throw Error(ErrorKind::no_device,
                  "the queue of the Vulkan device \"" + name +
                      "\" that neighboring elements use cannot compute; choose another driver or "
                      "put vulkandownload before this element");
  }

  std::mutex mutex_;
  std::vector<Entry> entries_;
};

VkPhysicalDeviceIDProperties identity(VkPhysicalDevice device) {
  VkPhysicalDeviceIDProperties ids{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  properties.pNext = &ids;
  vkGetPhysicalDeviceProperties2(device, &properties);
  return ids;
}

bool same_physical(VkPhysicalDevice a, VkPhysicalDevice b) {
  const auto x = identity(a), y = identity(b);
  return !memcmp(x.deviceUUID, y.deviceUUID, VK_UUID_SIZE) &&
         !memcmp(x.driverUUID, y.driverUUID, VK_UUID_SIZE);
}

/// Devices that were made for neighbors and live on. Those keep pools and command buffers on the
/// device that they had when they are stopped, and mix them with what they get when they start
/// again (1.22): it has to be the same device.
class Made {
 public:
  static Made& get() {
    static Made made;
    return made;
  }

  /// The one on this instance and physical device, or null.
  DeviceRef find(GstVulkanInstance* instance, VkPhysicalDevice physical) {
    std::lock_guard lock(mutex_);
    DeviceRef found;
    for (auto ref = refs_.begin(); ref != refs_.end();) {
      DeviceRef device(static_cast<GstVulkanDevice*>(g_weak_ref_get(&*ref)));
      if (!device) {
        g_weak_ref_clear(&*ref);
        ref = refs_.erase(ref);
        continue;
      }
      if (device->instance == instance &&
          gst_vulkan_device_get_physical_device(device.get()) == physical)
        found = std::move(device);
      ++ref;
    }
    return found;
  }
  void add(GstVulkanDevice* device) {
    std::lock_guard lock(mutex_);
    g_weak_ref_init(&refs_.emplace_back(), device);
  }

 private:
  std::mutex mutex_;
  std::list<GWeakRef> refs_;
};

/// Set while an element of this library queries its neighbors: they answer with the device that
/// they have, and create none.
thread_local bool querying = false;

[[noreturn]] void fail_to_open(const char* what, GError* error) {
  const std::string text =
      std::string(what) + " failed: " + (error ? error->message : "no reason given");
  g_clear_error(&error);
  throw Error(ErrorKind::no_device, text);
}

}  // namespace

namespace bridge {

DevicePtr adopt(GstElement* element, GstVulkanDevice* device) {
  GstVulkanQueue* queue = nullptr;
  gst_vulkan_queue_run_context_query(element, &queue);
  const QueueRef owned(queue);
  return Registry::get().adopt(device, queue && queue->device == device ? queue : nullptr);
}

HandlesPtr handles_of(const gpu::Device& device) { return Registry::get().handles_of(device); }

}  // namespace bridge

bool has_vulkan_images() { return true; }

bool same_hardware(const gpu::Device& a, const gpu::Device& b) {
  return same_physical(a.physical(), b.physical());
}

struct VulkanNeighbor::Contexts {
  GstVulkanInstance* instance = nullptr;
  DevicePtr device;
  HandlesPtr handles;

  ~Contexts() {
    if (instance) gst_object_unref(instance);
  }
};

VulkanNeighbor::VulkanNeighbor() : contexts_(std::make_unique<Contexts>()) {}
VulkanNeighbor::~VulkanNeighbor() = default;

DevicePtr VulkanNeighbor::find(GstElement* element, Ask ask) {
  GstVulkanDevice* found = nullptr;
  querying = ask == Ask::what_there_is;
  const bool any = gst_vulkan_device_run_context_query(element, &found);
  querying = false;
  if (!any) return nullptr;
  const DeviceRef owned(found);
  GError* error = nullptr;
  if (!gst_vulkan_device_open(found, &error)) fail_to_open("opening the neighbors' device", error);
  DevicePtr device = bridge::adopt(element, found);
  std::lock_guard lock(mutex_);
  contexts_->device = device;
  contexts_->handles = bridge::handles_of(*device);
  return device;
}

DevicePtr VulkanNeighbor::make(GstElement* element, const gpu::Device& like) {
  // The instance as gst_vulkan_ensure_element_data() finds it: had already, a neighbor's, the
  // pipeline's or the application's, a new one. No lock is held while others are asked.
  const auto noted = [this]() -> InstanceRef {
    std::lock_guard lock(mutex_);
    return InstanceRef(contexts_->instance ? add_ref(contexts_->instance) : nullptr);
  };
  InstanceRef instance = noted();
  if (!instance) {
    GstVulkanInstance* found = nullptr;
    gst_vulkan_instance_run_context_query(element, &found);
    instance.reset(found);
  }
  if (!instance) {
    gst_element_post_message(
        element,
        gst_message_new_need_context(GST_OBJECT(element), GST_VULKAN_INSTANCE_CONTEXT_TYPE_STR));
    instance = noted();
  }
  const bool ours = !instance;
  if (ours) instance.reset(gst_vulkan_instance_new());
  GError* error = nullptr;
  if (!gst_vulkan_instance_open(instance.get(), &error))
    fail_to_open("opening GStreamer's Vulkan instance", error);
  if (ours) {
    GstContext* context = gst_context_new(GST_VULKAN_INSTANCE_CONTEXT_TYPE_STR, TRUE);
    gst_context_set_vulkan_instance(context, instance.get());
    gst_element_set_context(element, context);
    gst_element_post_message(element, gst_message_new_have_context(GST_OBJECT(element), context));
  }

  guint index = 0;
  while (index < instance->n_physical_devices &&
         !same_physical(instance->physical_devices[index], like.physical()))
    ++index;
  if (index == instance->n_physical_devices)
    throw Error(ErrorKind::no_device, "GStreamer's Vulkan library does not see the device \"" +
                                          like.name() + "\"; choose another with device=");
  DeviceRef made = Made::get().find(instance.get(), instance->physical_devices[index]);
  DevicePtr device = made ? Registry::get().adopt(made.get(), nullptr) : nullptr;
  if (!device || device->lost()) {
    made.reset(gst_vulkan_device_new_with_index(instance.get(), index));
    if (!gst_vulkan_device_open(made.get(), &error))
      fail_to_open("opening a device for the neighbors", error);
    Made::get().add(made.get());
    device = Registry::get().adopt(made.get(), nullptr);
  }
  std::lock_guard lock(mutex_);
  contexts_->device = device;
  contexts_->handles = bridge::handles_of(*device);
  return device;
}

DevicePtr VulkanNeighbor::held() const {
  std::lock_guard lock(mutex_);
  return contexts_->device;
}

void VulkanNeighbor::set_context(GstElement* element, GstContext* context) {
  std::lock_guard lock(mutex_);
  gst_vulkan_handle_set_context(element, context, nullptr, &contexts_->instance);
}

bool VulkanNeighbor::answer(GstElement* element, GstQuery* query) const {
  HandlesPtr handles;
  {
    std::lock_guard lock(mutex_);
    handles = contexts_->handles;
  }
  if (!handles) return false;
  GstVulkanDevice* device = handles->device.get();
  return gst_vulkan_handle_context_query(element, query, nullptr, device->instance, device) ||
         gst_vulkan_queue_handle_context_query(element, query, handles->queue.get());
}

bool VulkanNeighbor::asks_for_device(GstQuery* query) {
  const gchar* type = nullptr;
  gst_query_parse_context_type(query, &type);
  return !querying && g_strcmp0(type, GST_VULKAN_DEVICE_CONTEXT_TYPE_STR) == 0;
}

void VulkanNeighbor::wait_for_neighbor() const {
  HandlesPtr handles;
  {
    std::lock_guard lock(mutex_);
    handles = contexts_->handles;
  }
  if (!handles) return;
  // A fence instead of vkQueueWaitIdle, which would wait for a hung device without end.
  constexpr uint64_t kTimeout = 10'000'000'000;  // nanoseconds
  const VkDevice device = handles->device->device;
  const VkFenceCreateInfo info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, nullptr, 0};
  VkFence fence = VK_NULL_HANDLE;
  if (vkCreateFence(device, &info, nullptr, &fence) != VK_SUCCESS) return;
  gst_vulkan_queue_submit_lock(handles->queue.get());
  const VkResult submitted = vkQueueSubmit(handles->queue->queue, 0, nullptr, fence);
  gst_vulkan_queue_submit_unlock(handles->queue.get());
  const VkResult waited =
      submitted == VK_SUCCESS ? vkWaitForFences(device, 1, &fence, VK_TRUE, kTimeout) : VK_SUCCESS;
  // After other results the device may still signal it.
  if (waited == VK_SUCCESS || waited == VK_ERROR_DEVICE_LOST)
    vkDestroyFence(device, fence, nullptr);
}

void VulkanNeighbor::release() {
  wait_for_neighbor();
  std::lock_guard lock(mutex_);
  contexts_ = std::make_unique<Contexts>();
}

}  // namespace inverse
