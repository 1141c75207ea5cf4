#include "vulkan_bridge.hpp"

extern "C" {  // 1.22 forgets to say so in gstvkqueue.h
#include <gst/vulkan/vulkan.h>
}

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "frame_io.hpp"

namespace inverse {
namespace {

using DevicePtr = std::shared_ptr<gpu::Device>;

struct Unref {
  void operator()(gpointer object) const { gst_object_unref(object); }
};
using InstanceRef = std::unique_ptr<GstVulkanInstance, Unref>;
using DeviceRef = std::unique_ptr<GstVulkanDevice, Unref>;
using QueueRef = std::unique_ptr<GstVulkanQueue, Unref>;
template <typename T>
T* add_ref(T* object) {
  return static_cast<T*>(gst_object_ref(object));
}

/// What GStreamer knows an adopted device by. Kept alive by the gpu::Device that wraps it.
struct Handles {
  DeviceRef device;
  QueueRef queue;
};
using HandlesPtr = std::shared_ptr<Handles>;

/// Which GstVulkanDevice is wrapped by which gpu::Device: planes can only be shared between
/// elements that hold the same object.
class Registry {
 public:
  static Registry& get() {
    static Registry registry;
    return registry;
  }

  /// The wrapped device; `queue` is where the neighbours submit, or null where nobody says.
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

  /// Null where GStreamer does not know the device.
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
                      "\" that neighbouring elements use has no Vulkan 1.1, which is needed; "
                      "choose another driver or put vulkandownload before this element");
    if (!handles.queue ||
        !(physical->queue_family_props[handles.queue->family].queueFlags & VK_QUEUE_COMPUTE_BIT))
      throw Error(ErrorKind::no_device,
                  "the queue of the Vulkan device \"" + name +
                      "\" that neighbouring elements use cannot compute; choose another driver or "
                      "put vulkandownload before this element");
  }

  std::mutex mutex_;
  std::vector<Entry> entries_;
};

/// Wraps a device whose queue the neighbours may know.
DevicePtr adopt(GstElement* element, GstVulkanDevice* device) {
  GstVulkanQueue* queue = nullptr;
  gst_vulkan_queue_run_context_query(element, &queue);
  const QueueRef owned(queue);
  return Registry::get().adopt(device, queue && queue->device == device ? queue : nullptr);
}

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

[[noreturn]] void fail_to_open(const char* what, GError* error) {
  const std::string text =
      std::string(what) + " failed: " + (error ? error->message : "no reason given");
  g_clear_error(&error);
  throw Error(ErrorKind::no_device, text);
}

}  // namespace

bool has_vulkan_images() { return true; }

bool same_hardware(const gpu::Device& a, const gpu::Device& b) {
  return same_physical(a.physical(), b.physical());
}

struct VulkanNeighbor::Contexts {
  GstVulkanInstance* instance = nullptr;
  DevicePtr device;
  HandlesPtr handles;

  ~Contexts() { gst_clear_object(&instance); }
};

VulkanNeighbor::VulkanNeighbor() : contexts_(std::make_unique<Contexts>()) {}
VulkanNeighbor::~VulkanNeighbor() = default;

DevicePtr VulkanNeighbor::find(GstElement* element) {
  GstVulkanDevice* found = nullptr;
  if (!gst_vulkan_device_run_context_query(element, &found)) return nullptr;
  const DeviceRef owned(found);
  GError* error = nullptr;
  if (!gst_vulkan_device_open(found, &error)) fail_to_open("opening the neighbours' device", error);
  DevicePtr device = adopt(element, found);
  std::lock_guard lock(mutex_);
  contexts_->device = device;
  contexts_->handles = Registry::get().handles_of(*device);
  return device;
}

DevicePtr VulkanNeighbor::make(GstElement* element, const gpu::Device& like) {
  // The instance as gst_vulkan_ensure_element_data() finds it: had already, a neighbour's, the
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
  const DeviceRef made(gst_vulkan_device_new_with_index(instance.get(), index));
  if (!gst_vulkan_device_open(made.get(), &error))
    fail_to_open("opening a device for the neighbours", error);
  DevicePtr device = Registry::get().adopt(made.get(), nullptr);
  std::lock_guard lock(mutex_);
  contexts_->device = device;
  contexts_->handles = Registry::get().handles_of(*device);
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
  return g_strcmp0(type, GST_VULKAN_DEVICE_CONTEXT_TYPE_STR) == 0;
}

void VulkanNeighbor::release() {
  std::lock_guard lock(mutex_);
  contexts_ = std::make_unique<Contexts>();
}

// ---- Frames ---------------------------------------------------------------------------------

namespace {

/// The image that a buffer holds.
GstVulkanImageMemory* image_of(GstBuffer* buffer) {
  GstMemory* memory =
      gst_buffer_n_memory(buffer) == 1 ? gst_buffer_peek_memory(buffer, 0) : nullptr;
  if (!gst_is_vulkan_image_memory(memory))
    throw Error(ErrorKind::unsupported,
                "a buffer whose caps promise memory:VulkanImage holds no such image; mend the "
                "element that sent it");
  return reinterpret_cast<GstVulkanImageMemory*>(memory);
}

/// Keeps an image, but not its buffer, which may go back to its pool before the device is done: the
/// next writer submits to the same queue, later.
std::shared_ptr<void> keep(GstVulkanImageMemory* image) {
  return {gst_memory_ref(GST_MEMORY_CAST(image)),
          [](void* memory) { gst_memory_unref(static_cast<GstMemory*>(memory)); }};
}

/// Four bytes a pixel, in the order of RGBA or BGRA.
bool is_copyable(VkFormat format) {
  return format == VK_FORMAT_R8G8B8A8_UNORM || format == VK_FORMAT_R8G8B8A8_SRGB ||
         format == VK_FORMAT_B8G8R8A8_UNORM || format == VK_FORMAT_B8G8R8A8_SRGB;
}

void note(GstVulkanImageMemory* image, VkAccessFlags access, VkImageLayout layout) {
  image->barrier.parent.pipeline_stages = VK_PIPELINE_STAGE_TRANSFER_BIT;
  image->barrier.parent.access_flags = access;
  image->barrier.image_layout = layout;
}

class ImageInput final : public FrameInput {
 public:
  using FrameInput::FrameInput;

  DevicePtr device_of(GstElement* element, GstBuffer* buffer) override {
    GstVulkanDevice* device = image_of(buffer)->device;
    if (!last_ || last_raw_ != device) {
      last_ = adopt(element, device);
      last_raw_ = device;
    }
    return last_;
  }
  gpu::BufferPtr make_buffer(const DevicePtr& device) const override {
    return gpu::Buffer::create(device, gpu::Element::word, raw_words(format_));
  }

 protected:
  void load(gpu::Commands& commands, GstBuffer* buffer, const gpu::BufferPtr& raw) const override {
    GstVulkanImageMemory* image = image_of(buffer);
    const VkExtent3D& extent = image->create_info.extent;
    if (extent.width != format_.extent.width || extent.height != format_.extent.height ||
        !is_copyable(image->create_info.format) ||
        !(image->create_info.usage & VK_IMAGE_USAGE_TRANSFER_SRC_BIT))
      throw Error(ErrorKind::unsupported,
                  "a Vulkan image of " + std::to_string(extent.width) + "x" +
                      std::to_string(extent.height) + " in VkFormat " +
                      std::to_string(image->create_info.format) +
                      " is not the 8-bit RGBA frame that can be copied from which its caps "
                      "promise; mend the element that sent it");
    const VkImageLayout before = image->barrier.image_layout;
    // As it was: another branch of a tee may have recorded, and not yet submitted, its own use.
    const VkImageLayout after =
        before == VK_IMAGE_LAYOUT_UNDEFINED ? VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL : before;
    commands.copy_from_image({image->image, before, after, extent.width, extent.height}, raw);
    note(image, VK_ACCESS_TRANSFER_READ_BIT, after);
    commands.keep(keep(image));
  }

 private:
  DevicePtr last_;  // of the last buffer; its GstVulkanDevice lives as long
  GstVulkanDevice* last_raw_ = nullptr;
};

class ImageOutput final : public FrameOutput {
 public:
  using FrameOutput::FrameOutput;

  bool waits() const override { return false; }
  gpu::BufferPtr make_buffer(const DevicePtr& device) const override {
    return gpu::Buffer::create(device, gpu::Element::word, raw_words(format_));
  }
  void write(const gpu::BufferPtr&, GstBuffer*) const override {}

 protected:
  void store(gpu::Commands& commands, const gpu::BufferPtr& raw, GstBuffer* buffer) const override {
    GstVulkanImageMemory* image = image_of(buffer);
    const VkImageLayout after = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    commands.copy_to_image(raw, {image->image, VK_IMAGE_LAYOUT_UNDEFINED, after,
                                 format_.extent.width, format_.extent.height});
    note(image, VK_ACCESS_TRANSFER_WRITE_BIT, after);
    commands.keep(keep(image));
  }
};

/// The library's own pool leaves out STORAGE (1.22) and asks nobody whether an image can be made.
struct ImagePool {
  GstBufferPool parent;
  GstVulkanDevice* device;
  VkImageCreateInfo image;
};

GstMemory* allocate(const ImagePool& pool) {
  return gst_vulkan_image_memory_alloc(pool.device, pool.image.format, pool.image.extent.width,
                                       pool.image.extent.height, pool.image.tiling,
                                       pool.image.usage, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
}

GType image_pool_type() {
  static const GType type = [] {
    GTypeInfo info{};
    info.class_size = sizeof(GstBufferPoolClass);
    info.instance_size = sizeof(ImagePool);
    info.class_init = [](gpointer klass, gpointer) {
      GST_BUFFER_POOL_CLASS(klass)->alloc_buffer = [](GstBufferPool* pool, GstBuffer** buffer,
                                                      GstBufferPoolAcquireParams*) {
        GstMemory* memory = allocate(*reinterpret_cast<ImagePool*>(pool));
        if (!memory) return GST_FLOW_ERROR;
        *buffer = gst_buffer_new();
        gst_buffer_append_memory(*buffer, memory);
        return GST_FLOW_OK;
      };
      G_OBJECT_CLASS(klass)->finalize = [](GObject* object) {
        GstVulkanDevice* device = reinterpret_cast<ImagePool*>(object)->device;
        // The parent frees the images, then the device may go.
        G_OBJECT_CLASS(g_type_class_peek(GST_TYPE_BUFFER_POOL))->finalize(object);
        gst_object_unref(device);
      };
    };
    return g_type_register_static(GST_TYPE_BUFFER_POOL, "GstInverseVulkanImagePool", &info,
                                  static_cast<GTypeFlags>(0));
  }();
  return type;
}

/// How images for frames of these caps are made on a device; throws Error(limit) where they cannot
/// be.
VkImageCreateInfo image_info(const gpu::Device& device, GstVideoInfo info) {
  VkImageCreateInfo image{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  image.format = gst_vulkan_format_from_video_info(&info, 0);
  image.extent = {static_cast<uint32_t>(GST_VIDEO_INFO_WIDTH(&info)),
                  static_cast<uint32_t>(GST_VIDEO_INFO_HEIGHT(&info)), 1};
  image.tiling = VK_IMAGE_TILING_OPTIMAL;
  image.usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                VK_IMAGE_USAGE_INPUT_ATTACHMENT_BIT;
  VkFormatProperties features;
  vkGetPhysicalDeviceFormatProperties(device.physical(), image.format, &features);
  if (features.optimalTilingFeatures & VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT)
    image.usage |= VK_IMAGE_USAGE_STORAGE_BIT;
  VkImageFormatProperties possible{};
  const VkResult result = vkGetPhysicalDeviceImageFormatProperties(
      device.physical(), image.format, VK_IMAGE_TYPE_2D, image.tiling, image.usage, 0, &possible);
  if (result != VK_SUCCESS || image.extent.width > possible.maxExtent.width ||
      image.extent.height > possible.maxExtent.height)
    throw Error(ErrorKind::limit, "the Vulkan device \"" + device.name() + "\" has no images of " +
                                      std::to_string(image.extent.width) + "x" +
                                      std::to_string(image.extent.height) + ", at most " +
                                      std::to_string(possible.maxExtent.width) + "x" +
                                      std::to_string(possible.maxExtent.height) +
                                      "; use a smaller frame or system memory");
  return image;
}

}  // namespace

std::unique_ptr<FrameInput> make_image_input(const GstVideoInfo& info) {
  return std::make_unique<ImageInput>(info);
}

std::unique_ptr<FrameOutput> make_image_output(const GstVideoInfo& info) {
  return std::make_unique<ImageOutput>(info);
}

GstBufferPool* make_image_pool(const DevicePtr& device, GstCaps* caps, guint* size) {
  const HandlesPtr handles = device ? Registry::get().handles_of(*device) : nullptr;
  GstVideoInfo info;
  if (!handles || !gst_video_info_from_caps(&info, caps))
    throw Error(ErrorKind::internal, "images were asked for on a device without GStreamer's part");
  const VkImageCreateInfo image = image_info(*device, info);
  std::unique_ptr<GstBufferPool, Unref> pool(
      GST_BUFFER_POOL(gst_object_ref_sink(g_object_new(image_pool_type(), nullptr))));
  auto* images = reinterpret_cast<ImagePool*>(pool.get());
  images->device = add_ref(handles->device.get());
  images->image = image;
  // One on trial: its size is what the pool will check buffers by.
  GstMemory* trial = allocate(*images);
  if (!trial)
    throw Error(ErrorKind::out_of_memory,
                "no memory for a Vulkan image of the output's size; use "
                "a smaller frame or fewer elements on this device");
  *size = static_cast<guint>(trial->size);
  gst_memory_unref(trial);
  GstStructure* config = gst_buffer_pool_get_config(pool.get());
  gst_buffer_pool_config_set_params(config, caps, *size, 0, 0);
  if (!gst_buffer_pool_set_config(pool.get(), config))
    throw Error(ErrorKind::internal, "a pool of Vulkan images refused its own configuration");
  return pool.release();
}

}  // namespace inverse
