// SPDX-License-Identifier: LGPL-2.1-or-later
#include "filter_element.hpp"

#include <gst/base/gstbasetransform.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <utility>

#include "gst/base/frames/video_format.hpp"
#include "gst/base/log/errors.hpp"
#include "gst/base/meta/layers_meta.hpp"
#include "report.hpp"
#include "views.hpp"

// Members log into the category of their element.
#define GST_CAT_DEFAULT (log_.category)

namespace inverse {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Posts messages, property changes and warnings of a frame.
void post_messages(const Log& log, FrameContext& frame) {
  GstElement* element = log.object;
  for (StructurePtr& message : frame.messages) {
    GST_CAT_DEBUG_OBJECT(log.category, element, "message: %" GST_PTR_FORMAT, message.get());
    gst_element_post_message(element,
                             gst_message_new_element(GST_OBJECT(element), message.release()));
  }
  for (const char* property : frame.notify) g_object_notify(G_OBJECT(element), property);
  for (const std::string& warning : frame.warnings)
    post_warning(log, GST_LIBRARY_ERROR, GST_LIBRARY_ERROR_SETTINGS, "%s", warning.c_str());
}

}  // namespace

FilterElement::FilterElement(GstElement* element, const ElementInfo& info)
    : element_(element),
      log_(log_of(element)),
      info_(info),
      filter_(info.create()),
      context_(element) {
  filter_->set_log(log_);
  gst_video_info_init(&in_info_);
  gst_video_info_init(&out_info_);
}

FilterElement::~FilterElement() {
  if (stats_) gst_structure_free(stats_);
}

bool FilterElement::open() {
  // Editors work on the device that their layers live on.
  if (!info_.takes_pixels()) return true;
  return guarded(element_, [&] { context_.acquire(device_name()); });
}

bool FilterElement::restart() {
  if (!check_parameters(log_, filter_->parameters())) return false;
  return guarded(element_, [&] {
    context_.renew(device_name());
    reported_ratio_ = {1, 1};
    reported_views_ = {""};  // no warning
    explained_ = false;
    reported_format_ = GST_VIDEO_FORMAT_UNKNOWN;
    filter_->start();
  });
}

void FilterElement::close() {
  stop();
  context_.release();
}

void FilterElement::finish_all() {
  if (device_ && device_->unresponsive()) return;  // a wait for it timed out before
  try {
    for (size_t i = 0; i < slots_.size(); ++i) finish(slots_[next_slot_ + i]);
  } catch (const std::exception& error) {
    GST_WARNING_OBJECT(element_, "the last frames were not finished: %s", error.what());
  }
}

void FilterElement::stop() {
  finish_all();
  slots_ = {};
  forget_repeats();
  input_.reset();
  output_.reset();
  planes_.reset();
  if (configured_) filter_->release();
  configured_ = false;
  device_.reset();
  images_device_.reset();
  memory_device_.reset();
  fresh_ = true;
  last_time_ = GST_CLOCK_TIME_NONE;
  frames_ = 0;
  asked_.set(nullptr, nullptr);
}

void FilterElement::ended() {
  finish_all();
  warn_on_error(log_, [&] { filter_->ended(); });
}

bool FilterElement::run(const Action& action, const GValue* arguments) {
  return warn_on_error(log_, [&] { action.run(*filter_, arguments); });
}

void FilterElement::configure(const std::shared_ptr<gpu::Device>& device) {
  const Extent extent = extent_of(in_info_);
  slots_ = {};
  forget_repeats();
  for (Slot& slot : slots_) slot.commands = std::make_unique<gpu::Commands>(device);
  planes_.emplace(device, extent);
  if (input_) input_->configure(device);
  if (output_) output_->configure(device);
  try {
    filter_->configure(device, extent_of(out_info_));
  } catch (...) {
    filter_->release();
    throw;
  }
  gpu::build_kernels(device);
  GST_INFO_OBJECT(element_, "device \"%s\", frames of %ux%u", device->name().c_str(), extent.width,
                  extent.height);
  device_ = device;
  // The first frame of layers carries the device: allocate again, on it.
  if (in_layers_ && output_ && output_->waits() && memory_device_ != device)
    gst_base_transform_reconfigure_src(GST_BASE_TRANSFORM(element_));
  configured_ = true;
  fresh_ = true;
  number_ = 0;
}

void FilterElement::set_flushing(bool flushing) {
  flushing_ = flushing;
  if (SidePads* pads = filter_->side_pads()) pads->set_flushing(flushing);
}

void FilterElement::start_scene(const char* reason) {
  GST_DEBUG_OBJECT(element_, "the next frame starts a new scene: %s", reason);
  fresh_ = true;
}

void FilterElement::flush(const char* reason) {
  start_scene(reason);
  filter_->flushed();
}

void FilterElement::start_stream(const char* id) {
  flush("new stream");
  if (std::exchange(stream_id_, id) != id) new_stream_ = true;
}

void FilterElement::wait(Slot& slot, const char* reason) {
  if (slot.commands->done()) {
    slot.commands->wait();
    return;
  }
  const auto start = Clock::now();
  if (!slot.commands->wait([&] { return transforms_ && flushing_.load(); })) throw Flushing{};
  GST_DEBUG_OBJECT(element_, "waited %.2f ms for the device: %s", milliseconds_since(start),
                   reason);
}

GstFlowReturn FilterElement::transform(GstBuffer* in, GstBuffer* out) {
  GstFlowReturn result = GST_FLOW_OK;
  transforms_ = true;
  const bool good = guarded(element_, [&] {
    const auto device = device_for(in);
    try {
      run_frame(in, out, device);
    } catch (const Flushing&) {
      GST_DEBUG_OBJECT(element_, "flushed in frame %" G_GUINT64_FORMAT, number_);
      result = GST_FLOW_FLUSHING;
    } catch (const Error& error) {
      throw with_largest_size(error, device);
    }
  });
  transforms_ = false;
  if (good && result == GST_FLOW_OK) return result;
  // What was recorded was never computed.
  forget_repeats();
  fresh_ = true;
  return good ? result : GST_FLOW_ERROR;
}

void FilterElement::forget_repeats() {
  repeats_.reset();
  if (input_) input_->forget();
  kept_input_.reset();
  drawn_.reset();
}

void FilterElement::read_input(GstBuffer* in, Slot& slot, FrameContext& frame) {
  if (in_layers_) {
    frame.layers = take_layers(in);
    return;
  }
  const bool compares = filter_->compares_frames();
  if (frame.fresh || !compares) forget_repeats();
  if (compares) {
    frame.repeated = input_->repeats(in);
    repeats_.next(frame.repeated);
  }
  frame.keep_planes = repeats_.going_on();
  frame.layers.extent = planes_->extent();
  convert_input(in, slot, frame);
}

void FilterElement::convert_input(GstBuffer* in, Slot& slot, FrameContext& frame) {
  PlanePtr& plane = frame.layers[Role::input];
  if (frame.repeated && kept_input_) {
    plane = kept_input_;
    return;
  }
  plane = planes_->acquire();
  input_->record(*slot.commands, in, slot.in, *plane);
  slot.commands->stage("unpack");
  kept_input_ = frame.keep_planes ? plane : nullptr;
}

void FilterElement::send(GstBuffer* out, Slot& slot, FrameContext& frame) {
  const bool again = frame.same_picture && drawn_ && output_->waits();
  gpu::BufferPtr direct;  // the memory of `out`, on the device
  if (!out_layers_ && !again) {
    // What goes out may be changed by others: the next frame's reuse needs a copy.
    if (!frame.same_picture) direct = output_->mapped(*device_, out);
    if (!direct && !slot.out) slot.out = output_->make_buffer(device_);
    drawn_ = direct ? nullptr : slot.out;
    output_->record(*slot.commands, frame.picture, frame.layers, direct ? direct : drawn_, out);
    slot.commands->stage("pack");
    if (direct) slot.commands->keep({gst_buffer_ref(out), gst_buffer_unref});
  }
  slot.commands->submit();
  if (out_layers_) {
    attach_layers(out, frame.layers);
  } else if (output_->waits()) {
    wait(slot, "to download the picture");
    if (direct) return;
    output_->write(drawn_, out);
    slot.commands->count_download(drawn_->bytes());
  }
}

std::shared_ptr<gpu::Device> FilterElement::device_for(GstBuffer* in) {
  if (in_layers_) {
    const Layers* layers = layers_of(in);
    const PlanePtr any = layers ? layers->any() : nullptr;
    if (!any)
      throw Error(ErrorKind::unsupported,
                  std::string("a buffer without layers reached ") + info_.factory +
                      "; an element before it dropped the layers meta, or is "
                      "of another build of gst-inverse");
    const auto width = static_cast<uint32_t>(GST_VIDEO_INFO_WIDTH(&in_info_));
    const auto height = static_cast<uint32_t>(GST_VIDEO_INFO_HEIGHT(&in_info_));
    if (layers->extent.width != width || layers->extent.height != height)
      throw Error(ErrorKind::unsupported,
                  "layers of " + std::to_string(layers->extent.width) + "x" +
                      std::to_string(layers->extent.height) + " reached " + info_.factory +
                      ", but their caps say " + std::to_string(width) + "x" +
                      std::to_string(height) +
                      "; scale or crop pictures only, before or after the elements with layers");
    return any->buffer->device();
  }
  if (!in_images_) return system_device();
  auto device = input_->device_of(element_, in);
  context_.permit(device);
  return device;
}

void FilterElement::run_frame(GstBuffer* in, GstBuffer* out,
                              const std::shared_ptr<gpu::Device>& device) {
  const auto start = Clock::now();
  GST_LOG_OBJECT(element_, "frame %" G_GUINT64_FORMAT ": %" GST_PTR_FORMAT, number_, in);
  if (images_device_ && device != images_device_)
    throw Error(ErrorKind::no_device,
                std::string("this pipeline needs two Vulkan devices at once: frames reach ") +
                    info_.factory + " on \"" + device->name() +
                    "\", and the images that it sends are expected on another device, opened by a "
                    "neighbor as \"" +
                    images_device_->name() +
                    "\"; let the elements share one (GstContext), or put vulkandownload and "
                    "vulkanupload between");
  if (!configured_ || device != device_) configure(device);
  Slot& slot = slots_[next_slot_];
  finish(slot);
  wait(slot, "for a frame that a flush ended");  // of which nobody waited for the end
  ++next_slot_;
  slot.commands->time_stages(gst_debug_category_get_threshold(log_.category) >= GST_LEVEL_DEBUG);
  slot.commands->begin();
  if (breaks_off(in)) start_scene("discontinuity");
  const bool fresh = fresh_.exchange(false);
  if (fresh) filter_->reset();
  if (const auto late = take_lateness()) filter_->late(*late);

  FrameContext frame{.commands = *slot.commands,
                     .layers = {},
                     .number = number_,
                     .in = in,
                     .time = stream_time(in),
                     .fresh = fresh,
                     .new_stream = new_stream_.exchange(false),
                     .draw = !out_layers_,
                     .alpha = !out_layers_ && GST_VIDEO_INFO_HAS_ALPHA(&out_info_),
                     .gray = !in_layers_ && GST_VIDEO_INFO_IS_GRAY(&in_info_),
                     .wait = [this](gpu::Commands& commands) {
                       if (!commands.wait([&] { return flushing_.load(); })) throw Flushing{};
                     }};
  read_input(in, slot, frame);
  if (!in_layers_ && info_.takes_frames())
    if (auto warning = misplaced_view(element_, *filter_, in);
        reported_views_.insert(warning).second)
      frame.warnings.push_back(std::move(warning));
  try {
    filter_->process(frame);
  } catch (...) {
    post_messages(log_, frame);
    throw;
  }
  post_messages(log_, frame);
  slot.number = number_++;  // also if its wait is ended by a flush
  send(out, slot, frame);
  if (frame.decorate) frame.decorate(out);
  if (!out_layers_) mark_shown(element_, *filter_, out);
  // vulkanupload overwrites its staging buffer with the next frame once this one is returned, even
  // if the device has not copied it yet (GStreamer 1.22): wait until it has.
  if (in_images_) wait(slot, "for the input image");
  slot.wall_ms = milliseconds_since(start);
  slot.pending = true;
  // Frames that are done by now, the oldest first, this one included if it was waited for.
  for (size_t i = 0; i < slots_.size(); ++i) {
    Slot& older = slots_[next_slot_ + i];
    if (older.pending && !older.commands->done()) break;  // it may be while the next one is asked
    finish(older);
  }
}

GstClockTime FilterElement::stream_time(GstBuffer* in) const {
  const GstSegment& segment = GST_BASE_TRANSFORM(element_)->segment;
  if (segment.format != GST_FORMAT_TIME) return GST_CLOCK_TIME_NONE;
  return gst_segment_to_stream_time(&segment, GST_FORMAT_TIME, GST_BUFFER_PTS(in));
}

bool FilterElement::breaks_off(GstBuffer* in) {
  // A frame or two dropped by a queue or by QoS is no new scene; methods find cuts themselves.
  constexpr GstClockTime kPause = GST_SECOND;
  const GstClockTime time = GST_BUFFER_PTS(in), before = last_time_;
  last_time_ = time;
  if (!GST_BUFFER_FLAG_IS_SET(in, GST_BUFFER_FLAG_DISCONT)) return false;
  if (!GST_CLOCK_TIME_IS_VALID(time) || !GST_CLOCK_TIME_IS_VALID(before)) return false;
  return time < before || time - before > kPause;
}

void FilterElement::finish(Slot& slot) {
  if (!slot.pending) return;
  slot.pending = false;
  try {
    wait(slot, "for a frame in flight");
  } catch (const Flushing&) {
    slot.pending = true;
    throw;
  }
  // If the device is not waited for, the wall clock does not measure the cost of a frame.
  filter_->completed(slot.number, std::max(slot.wall_ms, slot.commands->device_ms()));
  GstStructure* stats = frame_stats(*slot.commands, ++frames_, slot.wall_ms);
  filter_->describe(stats, slot.number);
  GST_DEBUG_OBJECT(element_, "frame %" G_GUINT64_FORMAT " is done: %" GST_PTR_FORMAT, slot.number,
                   stats);
  std::lock_guard lock(mutex_);
  std::swap(stats, stats_);
  if (stats) gst_structure_free(stats);
}

GstBufferPool* FilterElement::image_pool(GstCaps* caps, guint* size) {
  GstBufferPool* pool = nullptr;
  guarded(element_, [&] { pool = make_image_pool(images_device_, caps, size); });
  return pool;
}

void FilterElement::late(double milliseconds) {
  GST_DEBUG_OBJECT(element_, "quality of service: downstream is %.2f ms late", milliseconds);
  std::lock_guard lock(mutex_);
  late_ms_ = std::max(late_ms_.value_or(milliseconds), milliseconds);
}

std::optional<double> FilterElement::take_lateness() {
  std::lock_guard lock(mutex_);
  return std::exchange(late_ms_, {});
}

void FilterElement::announce_latency(GstClockTime latency) {
  if (latency_.exchange(latency) == latency) return;
  GST_DEBUG_OBJECT(element_, "latency %" GST_TIME_FORMAT, GST_TIME_ARGS(latency));
  gst_element_post_message(element_, gst_message_new_latency(GST_OBJECT(element_)));
}

void FilterElement::set_device_name(const char* name) {
  std::lock_guard lock(mutex_);
  device_name_ = name ? name : "";
}

std::string FilterElement::device_name() const {
  std::lock_guard lock(mutex_);
  return device_name_;
}

GstStructure* FilterElement::stats() {
  std::lock_guard lock(mutex_);
  return stats_ ? gst_structure_copy(stats_) : gst_structure_new_empty("inverse-stats");
}

}  // namespace inverse
