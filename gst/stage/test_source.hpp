#pragma once
#include <gst/video/video.h>

#include <memory>
#include <optional>
#include <string>

#include "base/device_context.hpp"
#include "base/frame_io.hpp"
#include "light_stage/sacn_receiver.hpp"
#include "olat_folder.hpp"
#include "test_source_params.hpp"
#include "virtual_stage/camera_schedule.hpp"
#include "virtual_stage/olat_stack.hpp"
#include "virtual_stage/virtual_camera.hpp"

namespace inverse {

/// What lightstagetestsrc does: a light program (or sACN packets), a head (or an OLAT folder) under
/// its lights, a camera that looks. The element around it has the clock and the pad.
class TestSource {
 public:
  explicit TestSource(GstElement* element) : element_(element), context_(element) {}
  ~TestSource();

  Parameters<TestSourceParams>& parameters() { return parameters_; }
  DeviceContext& context() { return context_; }
  std::string device_name() const;
  void set_device_name(const char* name);

  /// READY → PAUSED: reads program and folder, opens the port. Throws.
  void start();
  void stop();

  /// Video of the program's rate, and of the folder's size; before `start` of any. New reference.
  GstCaps* caps() const;
  /// Renders what these caps need. Takes as long as it takes. Throws.
  void set_caps(const GstVideoInfo& info);

  /// Period of the program, and from the start of a step to the middle of its exposure.
  GstClockTime time_of(uint64_t frame) const;
  GstClockTime period() const { return time_of(1); }
  GstClockTime until_exposure(uint64_t frame) const;
  /// Whether the program has ended before this frame; never with `listen`.
  bool ended(uint64_t frame) const;
  FrameFate fate(uint64_t frame) const;
  /// Draws a frame of the camera: what the lights do now. `time` is where it belongs.
  void draw(uint64_t frame, GstBuffer* buffer);
  /// How many frames went lost because this machine was too slow for a live camera.
  void overran(uint64_t frames) { overruns_ += frames; }
  void count(bool dropped, bool duplicated);

  /// New structure.
  GstStructure* stats() const;

 private:
  std::vector<LightColor> colors(uint64_t frame);
  void label(uint64_t frame, const std::vector<LightColor>& colors, GstBuffer* buffer) const;
  void publish(uint64_t frame, double wall_ms);

  GstElement* element_;
  DeviceContext context_;
  Parameters<TestSourceParams> parameters_{test_source_properties()};
  mutable std::mutex mutex_;  // device_name_, stats_
  std::string device_name_;
  GstStructure* stats_ = nullptr;

  TestSourceParams started_;  // what holds from start to stop
  LightProgram program_;
  uint64_t program_id_ = 0;
  std::optional<OlatFolder> folder_;
  std::optional<DmxPatch> patch_;
  std::optional<sacn::Receiver> receiver_;

  std::unique_ptr<OlatStack> stack_;
  double render_ms_ = 0;
  std::optional<VirtualCamera> camera_;
  std::unique_ptr<gpu::Commands> commands_;
  std::optional<PlanePool> pictures_;
  std::unique_ptr<FrameOutput> output_;
  gpu::BufferPtr readback_;
  uint64_t frames_ = 0, dropped_ = 0, duplicated_ = 0, overruns_ = 0;
};

}  // namespace inverse
