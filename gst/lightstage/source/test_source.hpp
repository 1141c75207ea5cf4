// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "gst/base/frames/frame_io.hpp"
#include "gst/base/vulkan/device_context.hpp"
#include "kernels/lightstage/controllers/sacn_receiver.hpp"
#include "kernels/lightstage/virtual_stage/camera_schedule.hpp"
#include "kernels/lightstage/virtual_stage/olat_stack.hpp"
#include "kernels/lightstage/virtual_stage/virtual_camera.hpp"
#include "olat_folder.hpp"
#include "test_source_params.hpp"

namespace inverse {

/// A frame of the camera.
struct Exposure {
  uint64_t number = 0;              ///< counted from the camera's first
  std::optional<uint64_t> trigger;  ///< of the program; nothing before its start
};

/// The implementation of lightstagetestsrc: a light program (or sACN packets), a head (or an OLAT
/// folder) under its lights, a camera. The element has the clock and the pad.
class TestSource {
 public:
  explicit TestSource(GstElement* element) : context_(element) {}
  ~TestSource();

  Parameters<TestSourceParams>& parameters() { return parameters_; }
  DeviceContext& context() { return context_; }
  /// As the properties say at the moment.
  TestSourceParams params() const { return parameters_.snapshot(); }

  /// READY → PAUSED: reads program and folder, opens the port. Returns a configuration warning,
  /// empty if there is none. Throws.
  std::string start();
  void stop();

  /// Video of the program's rate, and of the folder's size; before `start` of any. New reference.
  GstCaps* caps() const;
  /// Renders the views for these caps, which may take seconds; stops and returns false if `go_on`
  /// returns false meanwhile. Throws.
  bool set_caps(const GstVideoInfo& info, const std::function<bool()>& go_on);

  /// From running time 0 to the start of so many steps.
  GstClockTime time_of(uint64_t steps) const;
  GstClockTime period() const { return time_of(1); }
  /// Step at which the program starts, if it is set.
  std::optional<uint64_t> said_start() const;
  /// From the start of a step to the middle of its exposure.
  GstClockTime until_exposure(const Exposure& exposure) const;
  /// Whether the program has ended before this; never with `listen`.
  bool ended(const Exposure& exposure) const;
  FrameFate fate(const Exposure& exposure) const;
  /// Draws the camera's view under the current lights.
  void draw(const Exposure& exposure, GstBuffer* buffer);
  /// How many frames went lost because this machine was too slow for a live camera.
  void overran(uint64_t frames) { overruns_ += frames; }
  void count(bool dropped, bool duplicated);

  /// New structure.
  GstStructure* stats() const;

 private:
  std::unique_ptr<OlatStack> make_stack(const std::shared_ptr<gpu::Device>& device, Extent extent,
                                        const std::function<bool()>& go_on);
  void warm_up();
  std::vector<LightColor> colors(const Exposure& exposure);
  void label(const Exposure& exposure, const std::vector<LightColor>& colors,
             GstBuffer* buffer) const;
  void publish(const Exposure& exposure, double wall_ms);

  DeviceContext context_;
  Parameters<TestSourceParams> parameters_{test_source_properties()};
  mutable std::mutex mutex_;  // stats_
  GstStructure* stats_ = nullptr;

  TestSourceParams started_;  // constant from start to stop
  LightProgram program_;
  uint64_t program_id_ = 0;
  std::optional<OlatFolder> folder_;
  std::optional<DmxPatch> patch_;
  std::optional<sacn::Receiver> receiver_;

  std::unique_ptr<OlatStack> stack_;
  float full_on_ = 1;  // linear light of white under all lights, as the stack has it
  double render_ms_ = 0;
  std::optional<VirtualCamera> camera_;
  std::unique_ptr<gpu::Commands> commands_;
  std::optional<PlanePool> pictures_;
  std::unique_ptr<FrameOutput> output_;
  gpu::BufferPtr readback_;
  uint64_t frames_ = 0, dropped_ = 0, duplicated_ = 0, overruns_ = 0;
};

}  // namespace inverse
