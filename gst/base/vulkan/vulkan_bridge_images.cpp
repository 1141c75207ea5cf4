// SPDX-License-Identifier: LGPL-2.1-or-later
// Frames as images on a device of GStreamer's Vulkan library.
#include <mutex>
#include <string>

#include "gst/base/frames/frame_io.hpp"
#include "gst/base/meta/registered_once.hpp"
#include "vulkan_bridge.hpp"
#include "vulkan_bridge_detail.hpp"

namespace inverse {
namespace {

using bridge::add_ref;
using DevicePtr = std::shared_ptr<gpu::Device>;

/// The image that a buffer holds.
GstVulkanImageMemory* image_of(GstBuffer* buffer) {
  GstMemory* memory =
      gst_buffer_n_memory(buffer) == 1 ? gst_buffer_peek_memory(buffer, 0) : nullptr;
  if (!gst_is_vulkan_image_memory(memory))
    throw Error(ErrorKind::unsupported,
                "a buffer without a Vulkan image does not match its caps (memory:VulkanImage); fix "
                "the element that sent it");
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
      last_ = bridge::adopt(element, device);
      last_raw_ = device;
    }
    return last_;
  }
  gpu::BufferPtr make_buffer(const DevicePtr& device) const override {
    return gpu::Buffer::create(device, gpu::Element::word, raw_words(format_));
  }
  // What lies on the device is not copied to the host to be checked.
  bool repeats(GstBuffer*) override { return false; }

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
                      " does not match its caps: 8-bit RGBA or BGRA, copyable; fix the element "
                      "that sent it");
    static std::mutex notes;  // branches of a tee may read one image at a time
    std::lock_guard lock(notes);
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
  constexpr const char* kName = "GstInverseVulkanImagePool";
  static const GType type = type_registered_once(kName, [] {
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
    return g_type_register_static(GST_TYPE_BUFFER_POOL, kName, &info, static_cast<GTypeFlags>(0));
  });
  return type;
}

/// How images for frames of these caps are made on a device; throws Error(limit) if they cannot
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

std::unique_ptr<FrameOutput> make_image_output(const GstVideoInfo& info,
                                               GstVideoColorPrimaries planes) {
  return std::make_unique<ImageOutput>(info, planes);
}

GstBufferPool* make_image_pool(const DevicePtr& device, GstCaps* caps, guint* size) {
  const auto handles = device ? bridge::handles_of(*device) : nullptr;
  GstVideoInfo info;
  if (!handles || !gst_video_info_from_caps(&info, caps))
    throw Error(ErrorKind::internal, "images were asked for on a device without GStreamer's part");
  const VkImageCreateInfo image = image_info(*device, info);
  std::unique_ptr<GstBufferPool, UnrefObject> pool(
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
