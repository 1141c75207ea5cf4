#include "filter_element.hpp"

#include <chrono>

#include "errors.hpp"
#include "layers_meta.hpp"

namespace inverse {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

FilterElement::FilterElement(GstElement* element, const ElementInfo& info)
    : element_(element), info_(info), filter_(info.create()) {
  gst_video_info_init(&in_info_);
  gst_video_info_init(&out_info_);
}

FilterElement::~FilterElement() {
  if (stats_) gst_structure_free(stats_);
}

bool FilterElement::open() {
  // Editors work on the device that their layers live on.
  if (info_.sink != Flow::pixels) return true;
  return guarded(element_, [&] { device_ = context_.acquire(element_, device_name()); });
}

void FilterElement::close() {
  stop();
  device_.reset();
  context_.release();
}

void FilterElement::stop() {
  slots_ = {};
  input_.reset();
  output_.reset();
  planes_.reset();
  if (configured_) filter_->release();
  configured_ = false;
  fresh_ = true;
  frames_ = 0;
}

bool FilterElement::set_caps(GstCaps* in, GstCaps* out) {
  const std::string name = info_.factory;
  in_layers_ = carries_layers(in);
  out_layers_ = carries_layers(out);
  if (info_.sink != Flow::pixels && !in_layers_) {
    GST_ELEMENT_ERROR(
        element_, STREAM, FORMAT,
        ("%s works on decomposed video; insert %s before it", name.c_str(), info_.needs),
        ("got %" GST_PTR_FORMAT, in));
    return false;
  }
  if (!gst_video_info_from_caps(&in_info_, in) || !gst_video_info_from_caps(&out_info_, out)) {
    GST_ELEMENT_ERROR(element_, STREAM, FORMAT,
                      ("%s cannot make sense of the video format", name.c_str()),
                      ("in %" GST_PTR_FORMAT ", out %" GST_PTR_FORMAT, in, out));
    return false;
  }
  if (GST_VIDEO_INFO_IS_INTERLACED(&in_info_)) {
    GST_ELEMENT_ERROR(element_, STREAM, FORMAT,
                      ("%s needs progressive video; insert deinterlace before it", name.c_str()),
                      ("got %" GST_PTR_FORMAT, in));
    return false;
  }
  return guarded(element_, [&] {
    stop();
    // Refused formats show up here, before any frame.
    if (!in_layers_) input_.emplace(in_info_);
    if (!out_layers_) output_.emplace(out_info_);
    if (device_) configure(device_);
  });
}

void FilterElement::configure(const std::shared_ptr<gpu::Device>& device) {
  const Extent extent{static_cast<uint32_t>(GST_VIDEO_INFO_WIDTH(&in_info_)),
                      static_cast<uint32_t>(GST_VIDEO_INFO_HEIGHT(&in_info_))};
  slots_ = {};
  for (Slot& slot : slots_) {
    slot.commands = std::make_unique<gpu::Commands>(device);
    if (input_) slot.upload = input_->make_buffer(device);
    if (output_) slot.readback = output_->make_buffer(device);
  }
  planes_.emplace(device, extent);
  if (input_) input_->configure(device);
  if (output_) output_->configure(device);
  filter_->configure(device, extent);
  device_ = device;
  configured_ = true;
  fresh_ = true;
}

GstFlowReturn FilterElement::transform(GstBuffer* in, GstBuffer* out) {
  return guarded(element_, [&] { run(in, out); }) ? GST_FLOW_OK : GST_FLOW_ERROR;
}

Layers FilterElement::read_input(GstBuffer* in, Slot& slot) {
  if (in_layers_) return take_layers(in);
  Layers layers;
  layers.extent = planes_->extent();
  layers[Role::input] = planes_->acquire();
  input_->record(*slot.commands, in, slot.upload, *layers[Role::input]);
  return layers;
}

void FilterElement::run(GstBuffer* in, GstBuffer* out) {
  const auto start = Clock::now();
  if (in_layers_) {
    const Layers* layers = layers_of(in);
    if (!layers)
      throw Error(ErrorKind::unsupported, std::string("a buffer without layers reached ") +
                                              info_.factory +
                                              "; an element before it dropped the layers meta");
    const auto& device = (*layers)[Role::intrinsic]->buffer->device();
    if (!configured_ || device != device_) configure(device);
  }
  Slot& slot = slots_[next_slot_];
  next_slot_ = (next_slot_ + 1) % slots_.size();
  slot.commands->begin();
  if (GST_BUFFER_FLAG_IS_SET(in, GST_BUFFER_FLAG_DISCONT)) fresh_ = true;
  const bool fresh = fresh_.exchange(false);
  if (fresh) filter_->reset();

  FrameWork frame{*slot.commands, read_input(in, slot), fresh, !out_layers_, {}};
  if (!in_layers_) slot.commands->stage("unpack");
  filter_->process(frame);
  if (!out_layers_) {
    output_->record(*slot.commands, frame.picture, frame.layers, slot.readback);
    slot.commands->stage("pack");
  }
  slot.commands->submit();
  if (out_layers_) {
    attach_layers(out, frame.layers);
  } else {
    slot.commands->wait();
    output_->write(slot.readback, out);
  }
  ++frames_;
  publish(slot, milliseconds_since(start));
}

void FilterElement::publish(const Slot& slot, double wall_ms) {
  GstStructure* stats =
      gst_structure_new("inverse-stats", "frames", G_TYPE_UINT64, frames_, "device", G_TYPE_STRING,
                        device_->name().c_str(), "wall-ms", G_TYPE_DOUBLE, wall_ms, "device-bytes",
                        G_TYPE_UINT64, device_->memory_bytes(), "device-bytes-peak", G_TYPE_UINT64,
                        device_->memory_peak_bytes(), nullptr);
  double device_ms = 0;
  for (const auto& stage : slot.commands->stages()) {
    const std::string field = std::string(stage.name) + "-ms";
    gst_structure_set(stats, field.c_str(), G_TYPE_DOUBLE, stage.milliseconds, nullptr);
    device_ms += stage.milliseconds;
  }
  gst_structure_set(stats, "device-ms", G_TYPE_DOUBLE, device_ms, nullptr);
  filter_->describe(stats);
  std::lock_guard lock(mutex_);
  std::swap(stats, stats_);
  if (stats) gst_structure_free(stats);
}

GstClockTime FilterElement::latency() const {
  if (out_layers_ || GST_VIDEO_INFO_FPS_N(&out_info_) <= 0) return 0;
  return gst_util_uint64_scale_int(GST_SECOND, GST_VIDEO_INFO_FPS_D(&out_info_),
                                   GST_VIDEO_INFO_FPS_N(&out_info_));
}

void FilterElement::set_device_name(const char* name) {
  std::lock_guard lock(mutex_);
  device_name_ = name ? name : "";
}

std::string FilterElement::device_name() const {
  std::lock_guard lock(mutex_);
  return device_name_;
}

GstStructure* FilterElement::stats() const {
  std::lock_guard lock(mutex_);
  return stats_ ? gst_structure_copy(stats_) : gst_structure_new_empty("inverse-stats");
}

}  // namespace inverse
