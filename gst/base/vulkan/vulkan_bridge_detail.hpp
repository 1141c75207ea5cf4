// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
// Between the files of the Vulkan bridge: the GStreamer objects of an adopted device.
#include <gst/video/video.h>
extern "C" {  // missing in gstvkqueue.h of 1.22
#include <gst/vulkan/vulkan.h>
}

#include <memory>

#include "gst/base/pads/pads.hpp"
#include "kernels/gpu/device.hpp"

namespace inverse::bridge {

using InstanceRef = std::unique_ptr<GstVulkanInstance, UnrefObject>;
using DeviceRef = std::unique_ptr<GstVulkanDevice, UnrefObject>;
using QueueRef = std::unique_ptr<GstVulkanQueue, UnrefObject>;
template <typename T>
T* add_ref(T* object) {
  return static_cast<T*>(gst_object_ref(object));
}

/// Kept alive by the gpu::Device that wraps it.
struct Handles {
  DeviceRef device;
  QueueRef queue;
};

/// The wrapped device, with the queue that `element`'s neighbors submit to if they name it. The
/// same GstVulkanDevice gives the same object everywhere. Throws Error(no_device) if the kernels
/// cannot run on it.
std::shared_ptr<gpu::Device> adopt(GstElement* element, GstVulkanDevice* device);

/// Null if GStreamer did not make the device.
std::shared_ptr<Handles> handles_of(const gpu::Device& device);

}  // namespace inverse::bridge
