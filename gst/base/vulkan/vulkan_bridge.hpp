// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <memory>
#include <mutex>

#include "kernels/gpu/device.hpp"

namespace inverse {

class FrameInput;
class FrameOutput;

/// The caps feature of frames that are images on a device of GStreamer's Vulkan library.
inline constexpr const char* kVulkanImageFeature = "memory:VulkanImage";

/// Whether this build uses GStreamer's Vulkan library (meson option `vulkan-memory`). Without it no
/// template offers images, and nothing below is called.
bool has_vulkan_images();

/// One element's part in sharing a Vulkan device with elements of GStreamer's own Vulkan plugin
/// (GstContexts `gst.vulkan.instance`, `gst.vulkan.device`, `gst.vulkan.queue`). Thread-safe.
///
/// Those elements query for a device on READY → PAUSED, sinks first: downstream, then upstream. We
/// pass the query on and, if no other element answers, make a GstVulkanDevice on our physical
/// device. All end on one device and, as their submit lock belongs to a GstVulkanQueue and not to
/// the VkQueue, on one GstVulkanQueue.
class VulkanNeighbor {
 public:
  VulkanNeighbor();
  VulkanNeighbor(const VulkanNeighbor&) = delete;
  VulkanNeighbor& operator=(const VulkanNeighbor&) = delete;
  ~VulkanNeighbor();

  /// Searches for the device of neighbors, downstream first, and wraps it; null if there is none.
  /// The same GstVulkanDevice gives the same object everywhere in the process. Throws
  /// Error(no_device) if the kernels cannot run on it.
  enum class Ask {
    what_there_is,  ///< our elements do not make one
    make_one,       ///< the first of our elements makes one: images are about to flow
  };
  std::shared_ptr<gpu::Device> find(GstElement* element, Ask ask);
  /// Makes a device for the neighbors: a GstVulkanDevice on the physical device that `like` is on.
  /// Throws Error(no_device) if GStreamer's Vulkan library cannot open it.
  std::shared_ptr<gpu::Device> make(GstElement* element, const gpu::Device& like);
  /// What was found or made last; null if nothing was.
  std::shared_ptr<gpu::Device> held() const;

  /// GstElement::set_context: takes note of an instance.
  void set_context(GstElement* element, GstContext* context);
  /// Answers a query for instance, device or queue with those of the device held; false if the
  /// query is about something else or nothing is held.
  bool answer(GstElement* element, GstQuery* query) const;
  /// Whether a query asks for a device.
  static bool asks_for_device(GstQuery* query);

  /// Waits until the device held has done all that was submitted to it, by whomever. vulkanupload
  /// frees what the device still reads if a stream stops in the middle of a frame (GStreamer
  /// 1.22).
  void wait_for_neighbor() const;
  /// Waits, then releases.
  void release();

 private:
  struct Contexts;
  mutable std::mutex mutex_;
  std::unique_ptr<Contexts> contexts_;
};

/// Whether two devices are the same piece of hardware (or software), each opened on its own.
bool same_hardware(const gpu::Device& a, const gpu::Device& b);

/// From an image in `memory:VulkanImage` to a linear plane. RGBA and BGRA only; whether Vulkan
/// calls the bytes SRGB or UNORM makes no difference, as they are copied. Throws as FrameInput.
std::unique_ptr<FrameInput> make_image_input(const GstVideoInfo& info);

/// From planes to an image in `memory:VulkanImage`, without waiting: the consumer submits to the
/// same queue, later, behind the barrier that the memory names.
std::unique_ptr<FrameOutput> make_image_output(const GstVideoInfo& info,
                                               GstVideoColorPrimaries planes);

/// A configured pool of images on `device`, which VulkanNeighbor wrapped; `size` becomes the size
/// of its buffers. New reference. Throws Error(limit) if the device has no images of this size,
/// Error(out_of_memory), and Error(internal) if the device is no GstVulkanDevice.
GstBufferPool* make_image_pool(const std::shared_ptr<gpu::Device>& device, GstCaps* caps,
                               guint* size);

}  // namespace inverse
