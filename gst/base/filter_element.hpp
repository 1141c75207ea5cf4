// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <atomic>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "filter.hpp"
#include "gst/base/frames/frame_io.hpp"
#include "gst/base/vulkan/device_context.hpp"
#include "kernels/reuse/repeats.hpp"

namespace inverse {

inline Extent extent_of(const GstVideoInfo& info) {
  return {static_cast<uint32_t>(GST_VIDEO_INFO_WIDTH(&info)),
          static_cast<uint32_t>(GST_VIDEO_INFO_HEIGHT(&info))};
}

/// Device, caps, frames in flight and stats of a GstInverseFilter. filter.cpp binds it to GObject;
/// filter_caps.cpp has what is about caps and sizes.
class FilterElement {
 public:
  FilterElement(GstElement* element, const ElementInfo& info);

  /// NULL → READY: elements that take pixels take a device. READY → NULL: frees the device.
  bool open();
  void close();
  /// READY → PAUSED: takes another device if the last one was lost; the filter reads files.
  bool restart();
  /// PAUSED → READY: forgets caps and frames.
  void stop();

  /// Posts one error that names the nearest formats if these caps have a format of raw video that
  /// is not supported.
  void check_format(const GstCaps* caps);
  /// Checks fixed caps; posts one error and returns false if they cannot be handled.
  bool set_caps(GstCaps* in, GstCaps* out);
  /// Caps were refused downstream: posts one error if an editor sends layers to what takes none.
  void explain_refusal();
  /// Takes one buffer through the filter into `out`, which has memory only if pixels go out.
  GstFlowReturn transform(GstBuffer* in, GstBuffer* out);
  /// A flush began, or ended: a frame that waits for the device stops doing so. From any thread.
  void set_flushing(bool flushing);
  /// The next frame starts afresh, without what users asked for; `reason` is for the log.
  void flush(const char* reason);
  /// So it does, and is the first of a stream; not if `id` is that of the stream before.
  void start_stream(const char* id);
  /// The stream ended, or will stop.
  void ended();
  /// Runs an action signal; posts a warning and returns false if it throws. From any thread.
  bool run(const Action& action, const GValue* arguments);
  /// Downstream said how late a frame was (negative: early). From any thread.
  void late(double milliseconds);

  const Log& log() const { return log_; }
  Filter& filter() { return *filter_; }
  DeviceContext& context() { return context_; }
  /// Answers an allocation query from upstream with memory that kernels read without a copy, and
  /// completes one that downstream answered if our own memory may go out.
  void propose_memory(GstQuery* query);
  void decide_memory(GstQuery* query);
  /// A configured pool for the images that go out; posts one error and returns null if there can be
  /// none. New reference; `size` becomes the size of its buffers.
  GstBufferPool* image_pool(GstCaps* caps, guint* size);
  bool sends_layers() const { return out_layers_; }
  bool sends_images() const { return images_device_ != nullptr; }
  /// Whether frames go out in another size than they came in (ElementInfo::plain_caps).
  bool resizes() const {
    return GST_VIDEO_INFO_WIDTH(&in_info_) != GST_VIDEO_INFO_WIDTH(&out_info_);
  }
  /// Maximum time of a frame in the element: one frame duration if pixels go out, else 0.
  GstClockTime latency() const { return latency_; }

  void set_device_name(const char* name);
  std::string device_name() const;
  /// A copy of the stats of the last completed frame. Its stages are timed if the category logged
  /// at DEBUG.
  GstStructure* stats();

 private:
  struct Slot {
    std::unique_ptr<gpu::Commands> commands;
    gpu::BufferPtr in, out;  // the bytes of a frame, if it is copied
    uint64_t number = 0;     // FrameContext's
    double wall_ms = 0;
    bool pending = false;  // stats are yet to be published
  };
  bool try_caps(GstCaps* in, GstCaps* out);
  /// Warns of pixels that are not square if the filter needs them so; once for each ratio.
  void check_pixel_aspect_ratio();
  void configure(const std::shared_ptr<gpu::Device>& device);
  /// The error, with the largest size that the device can handle if it is about a limit; the
  /// element is no longer configured then.
  Error with_largest_size(const Error& error, const std::shared_ptr<gpu::Device>& device);
  /// Whether planes and the filter's state for input of this size can be made.
  bool fits(const std::shared_ptr<gpu::Device>& device, Extent in);
  std::shared_ptr<gpu::Device> device_for(GstBuffer* in);
  /// The device of frames in system memory; null before `open`.
  std::shared_ptr<gpu::Device> system_device() const {
    return images_device_ ? images_device_ : context_.current();
  }
  /// An allocator for frames of the query's caps; null if kernels cannot use them in place.
  GstAllocator* allocator_for(GstCaps* caps, const std::shared_ptr<gpu::Device>& device);
  void run_frame(GstBuffer* in, GstBuffer* out, const std::shared_ptr<gpu::Device>& device);
  void read_input(GstBuffer* in, Slot& slot, FrameContext& frame);
  /// Converts a frame from memory, unless it is repeated and its plane is kept.
  void convert_input(GstBuffer* in, Slot& slot, FrameContext& frame);
  /// Drops what a frame whose picture comes again could reuse.
  void forget_repeats();
  void send(GstBuffer* out, Slot& slot, FrameContext& frame);
  GstClockTime stream_time(GstBuffer* in) const;
  /// The next frame has nothing to do with those before it; `reason` is for the log.
  void start_scene(const char* reason);
  /// Whether `in` has nothing to do with the frame before it.
  bool breaks_off(GstBuffer* in);
  /// Waits until a frame's work on the device is done. Throws Flushing if the pipeline flushes
  /// while a frame is transformed.
  void wait(Slot& slot, const char* reason);
  /// Waits for a slot's frame and publishes its stats, once.
  void finish(Slot& slot);
  /// So with all slots, the oldest first; errors are logged.
  void finish_all();
  void announce_latency(GstClockTime latency);
  std::optional<double> take_lateness();

  GstElement* element_;
  Log log_;
  const ElementInfo& info_;
  std::unique_ptr<Filter> filter_;
  DeviceContext context_;
  std::string device_name_;
  std::shared_ptr<gpu::Device> device_;         // the one configured for
  std::shared_ptr<gpu::Device> images_device_;  // of the images that go out; null: none do
  std::shared_ptr<gpu::Device> memory_device_;  // of the memory that goes out; null: system memory

  GstVideoInfo in_info_, out_info_;
  CapsPair asked_;                            // last
  bool refused_ = false;                      // asked_ was answered with an error
  bool explained_ = false;                    // posted an error of what downstream refused
  std::pair<int, int> reported_ratio_{1, 1};  // of pixels, that was warned of last
  std::set<std::string> reported_views_{""};  // warnings of pictures of layers, and none
  GstVideoFormat reported_format_ = GST_VIDEO_FORMAT_UNKNOWN;  // last, by check_format
  bool in_layers_ = false, in_images_ = false, out_layers_ = false;
  bool configured_ = false;
  std::atomic<bool> fresh_{true}, new_stream_{false}, flushing_{false};
  bool transforms_ = false;  // a frame, now
  std::unique_ptr<FrameInput> input_;
  std::unique_ptr<FrameOutput> output_;
  std::optional<PlanePool> planes_;
  Repeats repeats_;
  PlanePtr kept_input_;   // of the frame before, while repeats go on
  gpu::BufferPtr drawn_;  // the slot's buffer with the bytes of the frame before
  gpu::FrameRing<Slot> slots_;
  size_t next_slot_ = 0;
  uint64_t number_ = 0;  // frames since `configure`
  uint64_t frames_ = 0;  // completed since the stream began
  GstClockTime last_time_ = GST_CLOCK_TIME_NONE;
  std::string stream_id_;
  std::atomic<GstClockTime> latency_{0};

  mutable std::mutex mutex_;  // device_name_, stats_, late_ms_
  GstStructure* stats_ = nullptr;
  std::optional<double> late_ms_;  // the maximum since the frame before

 public:
  FilterElement(const FilterElement&) = delete;
  FilterElement& operator=(const FilterElement&) = delete;
  ~FilterElement();
};

}  // namespace inverse
