// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "gst/base/log/log.hpp"
#include "gst/base/vulkan/device_context.hpp"
#include "gst/lightstage/sync/lights/light_clock.hpp"
#include "gst/lightstage/sync/lights/stage_trigger.hpp"
#include "kernels/lightstage/triggers/frame_sets.hpp"
#include "sync_camera.hpp"

namespace inverse {

/// The implementation of lightstagesync: cameras, the sets of their frames, and waits between them.
/// lightstagesync.cpp binds it to GObject.
///
/// Each sink pad's thread labels its frames and appends them to a line. Once a set is decided, its
/// frames go on to the threads of the source pads, one for each, which assemble and push them: a
/// slow branch after one camera does not block the others.
class SyncElement {
 public:
  using CameraPtr = std::shared_ptr<SyncCamera>;

  explicit SyncElement(GstElement* element)
      : element_(element), log_(log_of(element)), context_(element) {}
  SyncElement(const SyncElement&) = delete;
  SyncElement& operator=(const SyncElement&) = delete;
  ~SyncElement();

  /// NULL → READY … PAUSED → READY. `start` reads the program; false if that failed, and says
  /// why.
  bool start();
  void stop();
  void set_playing(bool playing);

  CameraPtr add(uint32_t number, GstPad* sink, GstPad* src);
  CameraPtr find(GstPad* pad) const;
  bool has(uint32_t number) const;
  void remove(const CameraPtr& camera);

  GstFlowReturn chain(const CameraPtr& camera, GstBuffer* buffer);
  /// Takes ownership of the event.
  gboolean sink_event(const CameraPtr& camera, GstEvent* event);
  gboolean sink_query(const CameraPtr& camera, GstQuery* query);
  /// Takes ownership of the event.
  gboolean src_event(const CameraPtr& camera, GstEvent* event);
  gboolean src_query(const CameraPtr& camera, GstQuery* query);
  bool activate_sink(const CameraPtr& camera, bool active);
  bool activate_src(const CameraPtr& camera, bool active);

  const Log& log() const { return log_; }
  DeviceContext& context() { return context_; }
  PropertyStore& parameters() { return parameters_; }
  GstStructure* stats() const;

 private:
  using Lock = std::unique_lock<std::mutex>;
  using Clock = SyncCamera::Clock;
  static void push_task(gpointer pad);
  void push_out(SyncCamera& camera);
  bool take_out(SyncCamera& camera, SyncCamera::Item& item);
  GstFlowReturn send(SyncCamera& camera, SyncCamera::Item& item);
  gboolean query_in_line(SyncCamera& camera, GstQuery* query);
  void answer(SyncCamera& camera, GstQuery* query);
  bool set_caps(SyncCamera& camera, GstCaps* caps);
  FrameLabeler::Params labeler_params(uint32_t source_id_bits = 0) const;
  void make_labeler(SyncCamera& camera);
  void ask_upstream(SyncCamera& camera);
  Clock::duration periods(uint32_t count) const;  // of the program
  std::shared_ptr<StageTrigger> make_trigger(const SyncParams& params,
                                             std::shared_ptr<const StageLabels> labels) const;
  double frame_timeout() const;
  std::vector<FrameLabeler::Labeled> triggered(SyncCamera& camera, uint64_t token,
                                               const std::optional<uint64_t>& trigger) const;
  FrameLabeler::Counts counts_of(const SyncCamera& camera) const;
  void make_assembler(SyncCamera& camera);
  GstFlowReturn combined_flow(const SyncCamera& camera) const;
  GstStructure* camera_stats(const SyncCamera& camera) const;

  // With the mutex locked.
  uint64_t max_steps() const;
  GstClockTime own_latency() const;
  size_t max_in_sets(const SyncCamera& camera) const;
  size_t max_outgoing(const SyncCamera& camera) const;
  Clock::duration longest_silence(const SyncCamera& camera) const;
  bool can_wait(const SyncCamera& camera) const;
  uint64_t newest_run() const;
  std::optional<FrameLabeler::Running> running_for(const SyncCamera& camera, GstClockTime pts,
                                                   GstClockTime time) const;

  // With the mutex locked; `post` sends their messages once it is not.
  void start_stream(SyncCamera& camera, GstEvent* event);
  void end_program(SyncCamera& camera, bool over);
  /// Logs the label of a frame, or why it has none (DEBUG).
  void log_label(const SyncCamera& camera, const SyncCamera::Item& item,
                 const FrameLabeler::Labeled& frame, bool passes) const;
  void labeled(SyncCamera& camera, const std::vector<FrameLabeler::Labeled>& frames);
  void advance();
  void report_stalled_cameras();
  void report(SyncCamera& camera);
  void join_run(SyncCamera& camera, const FrameLabeler::Labeled& frame);
  void leave_alone(SyncCamera& camera);
  void lacked_ended(uint32_t number);
  void warn(const std::string& text);
  void report_event(const char* event, const SyncCamera& camera, GstStructure* more = nullptr);
  void post(Lock& lock);

  static constexpr auto kCheckEvery = std::chrono::milliseconds(50);  ///< while a thread waits
  static constexpr uint32_t kLongestWait = 30;  ///< periods that a frame may wait for its label

  GstElement* element_;
  Log log_;
  DeviceContext context_;
  Parameters<SyncParams> parameters_{sync_properties()};
  SyncParams params_;  // as of `start`

  std::unique_ptr<LightClock> lights_;  // lives from `start` to `stop`

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::map<uint32_t, CameraPtr> cameras_;
  std::shared_ptr<const StageLabels> labels_;
  uint64_t max_steps_ = 0;                 // of this program, cached
  std::shared_ptr<StageTrigger> trigger_;  // with camera-trigger
  FrameSets sets_{true};
  uint64_t next_token_ = 1;
  uint64_t lacked_ended_ = 0;  // frames dropped since a camera has ended
  uint64_t run_ = 0;
  Clock::time_point run_since_{};
  bool playing_ = false;
  std::vector<uint32_t> lacking_;  // cameras that the oldest set waits for, and since when
  Clock::time_point lacking_since_{};
  std::vector<GstMessage*> messages_;
  std::vector<std::string> warnings_;
};

}  // namespace inverse
