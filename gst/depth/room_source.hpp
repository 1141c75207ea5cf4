// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "gst/base/frames/frame_io.hpp"
#include "gst/base/property_table.hpp"
#include "gst/base/vulkan/device_context.hpp"
#include "kernels/depth/virtual_room/virtual_room.hpp"

namespace inverse {

/// The parameters of rgbdtestsrc.
struct RoomSourceParams {
  enum class Show : uint8_t { color, reflectance, shading, depth };

  std::string device;
  bool live = true;
  RoomPath path = RoomPath::orbit;
  Show show = Show::color;
  HandTarget hand = HandTarget::none;
  float speed = 1;
  float depth_noise = 1;
  float max_depth = 8;
  unsigned samples = 2;
  unsigned seed = 1;
};

const PropertyTable<RoomSourceParams>& room_source_properties();

/// The implementation of rgbdtestsrc: a camera with depth in the virtual room. The element has the
/// clock and the pad.
class RoomSource {
 public:
  explicit RoomSource(GstElement* element) : context_(element) {}
  ~RoomSource();

  Parameters<RoomSourceParams>& parameters() { return parameters_; }
  DeviceContext& context() { return context_; }
  RoomSourceParams params() const { return parameters_.snapshot(); }

  /// Makes what frames of these caps need. Throws.
  void set_caps(const GstVideoInfo& info);
  void stop();
  /// Draws what the camera sees `seconds` after its start, and adds the depth.
  void draw(double seconds, uint64_t frame, GstBuffer* buffer);
  /// New structure.
  GstStructure* stats() const;

 private:
  void attach_depth(const Pose& pose, GstBuffer* buffer) const;

  DeviceContext context_;
  Parameters<RoomSourceParams> parameters_{room_source_properties()};
  mutable std::mutex mutex_;  // stats_
  GstStructure* stats_ = nullptr;

  Extent extent_;
  std::optional<VirtualRoom> room_;
  std::unique_ptr<gpu::Commands> commands_;
  PlanePtr layers_, truth_, picture_;
  gpu::BufferPtr pose_, depth_, depth_readback_, readback_;
  std::unique_ptr<FrameOutput> output_;
  uint64_t frames_ = 0;
};

}  // namespace inverse
