// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <memory>
#include <mutex>
#include <string>

#include "kernels/gpu/device.hpp"
#include "vulkan_bridge.hpp"

namespace inverse {

/// The context type under which elements of one pipeline share a device.
inline constexpr const char* kDeviceContext = "gst.inverse.device";

/// One element's part in sharing a Vulkan device with its neighbors: with our own elements as
/// GstContext `gst.inverse.device`, with those of GStreamer's Vulkan plugin through VulkanNeighbor.
/// One device serves a pipeline. Where the neighbors have one, it is theirs, unless the property
/// `device` or the application demands another; frames that would need both are refused.
class DeviceContext {
 public:
  explicit DeviceContext(GstElement* element) : element_(element) {}

  /// The device for the element, from NULL → READY on: if `select` is not empty, the one that it
  /// names. Else, in this order: one that was set on the element (now or before an earlier start),
  /// a neighbor's, one that the application provides on request, the best there is. A device that
  /// is opened here is announced to the rest of the pipeline. Throws Error(no_device).
  void acquire(const std::string& select);
  /// Acquires again if the device was lost since. Throws Error(no_device).
  void renew(const std::string& select);
  void release();
  /// Waits for what Vulkan neighbors have left on their device when they were stopped.
  void wait_for_neighbor() const { neighbor_.wait_for_neighbor(); }

  /// Searches again for a device of Vulkan neighbors: some of them only have one in PAUSED. Throws
  /// Error(no_device) if the kernels cannot run on it.
  void find_neighbor();
  /// The device to use for frames that are bound to none; null before `acquire`.
  std::shared_ptr<gpu::Device> current() const;
  /// The device on which the neighbors expect images, after `find_neighbor`; if none of them has
  /// one it is made. Throws Error(no_device) if that is not the device that is demanded.
  std::shared_ptr<gpu::Device> for_images();
  /// Throws Error(no_device) if frames lie on `device` and another one is demanded.
  void permit(const std::shared_ptr<gpu::Device>& device) const;

  /// GstElement::set_context: takes note of a device.
  void set_context(GstContext* context);
  /// Answers a context query with what is in use; false if the query is about something else.
  bool answer(GstQuery* query);
  /// Answers a context query that nobody else had an answer to, by making a device for the
  /// neighbors.
  bool provide(GstQuery* query);

 private:
  using DevicePtr = std::shared_ptr<gpu::Device>;
  enum class Demand { none, property, application };
  bool permitted(const gpu::Device& device) const;  // mutex_ held

  GstElement* element_;
  VulkanNeighbor neighbor_;
  mutable std::mutex mutex_;
  DevicePtr device_;                   // taken at READY
  DevicePtr offered_;                  // by the application or one of our elements
  gpointer offered_family_ = nullptr;  // the pipeline in which that was announced
  Demand demand_ = Demand::none;       // who insists on device_
};

}  // namespace inverse
