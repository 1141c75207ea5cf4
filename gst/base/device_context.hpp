#pragma once
#include <gst/gst.h>

#include <memory>
#include <mutex>
#include <string>

#include "gpu/device.hpp"

namespace inverse {

/// The context type under which elements of one pipeline share a device.
inline constexpr const char* kDeviceContext = "gst.inverse.device";

/// One element's part in sharing a Vulkan device with its neighbours (GstContext
/// `gst.inverse.device`).
class DeviceContext {
 public:
  /// The device for `element`: where `select` is not empty, the one that it names. Else, in this
  /// order: one that was set on the element, a neighbour's, one that the application provides on
  /// request, the best there is. A device that is opened here is announced to the rest of the
  /// pipeline. Throws Error(no_device).
  std::shared_ptr<gpu::Device> acquire(GstElement* element, const std::string& select);
  void release();

  /// GstElement::set_context: takes note of a device.
  void set_context(GstContext* context);
  /// Answers a context query with the device in use; false where the query is about something else.
  bool answer(GstQuery* query);

 private:
  std::mutex mutex_;
  std::shared_ptr<gpu::Device> device_;   // in use
  std::shared_ptr<gpu::Device> offered_;  // by the application or a neighbour
};

}  // namespace inverse
