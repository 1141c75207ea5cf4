// SPDX-License-Identifier: LGPL-2.1-or-later
// What a FilterElement can be asked for: caps, and sizes that the device can handle.
#include <gst/base/gstbasetransform.h>

#include <algorithm>
#include <utility>

#include "filter_element.hpp"
#include "gst/base/frames/video_format.hpp"
#include "gst/base/log/errors.hpp"
#include "gst/base/pads/largest_size.hpp"
#include "gst/base/pads/missing_layers.hpp"
#include "report.hpp"

// Members log into the category of their element.
#define GST_CAT_DEFAULT (log_.category)

namespace inverse {
namespace {

/// The elements that make progressive video of this format here: deinterlace of GStreamer 1.22
/// passes more than 8 bits on as they are.
std::string deinterlace_for(const GstVideoInfo& info) {
  GstElementFactory* factory = gst_element_factory_find("deinterlace");
  if (!factory) return "deinterlace (gstreamer1.0-plugins-good)";
  bool takes = false;
  for (const GList* item = gst_element_factory_get_static_pad_templates(factory); item;
       item = item->next) {
    auto* pad = static_cast<GstStaticPadTemplate*>(item->data);
    if (pad->direction != GST_PAD_SINK) continue;
    GstCaps* caps = gst_static_caps_get(&pad->static_caps);
    GstCaps* own = gst_caps_new_simple("video/x-raw", "format", G_TYPE_STRING,
                                       GST_VIDEO_INFO_NAME(&info), nullptr);
    for (guint i = 0; i < gst_caps_get_size(caps) && !takes; ++i) {
      if (gst_caps_features_is_any(gst_caps_get_features(caps, i))) continue;  // passed on
      GstCaps* one = gst_caps_copy_nth(caps, i);
      takes = gst_caps_can_intersect(own, one);
      gst_caps_unref(one);
    }
    gst_caps_unref(own);
    gst_caps_unref(caps);
  }
  gst_object_unref(factory);
  return takes ? "deinterlace"
               : std::string(
                     "deinterlace behind \"videoconvert ! video/x-raw,format=Y42B\" (it passes ") +
                     GST_VIDEO_INFO_NAME(&info) + " on as it is)";
}

}  // namespace

void FilterElement::check_format(const GstCaps* caps) {
  const GstStructure* structure = gst_caps_get_structure(caps, 0);
  const char* name = gst_structure_get_string(structure, "format");
  if (!name || !gst_structure_has_name(structure, "video/x-raw")) return;
  const GstVideoFormat format = gst_video_format_from_string(name);
  // Once: an element that pushes on after an error sends the caps with every buffer.
  if (format == std::exchange(reported_format_, format) || format == GST_VIDEO_FORMAT_UNKNOWN)
    return;
  guarded(element_, [&] { video_format(format); });
}

bool FilterElement::set_caps(GstCaps* in, GstCaps* out) {
  // Once: an element that pushes on after an error asks again with every buffer.
  if (refused_ && asked_.is(in, out)) return false;
  refused_ = !try_caps(in, out);
  asked_.set(in, out);
  if (refused_)
    GST_WARNING_OBJECT(element_, "refused caps: in %" GST_PTR_FORMAT ", out %" GST_PTR_FORMAT, in,
                       out);
  else
    GST_INFO_OBJECT(element_, "caps: in %" GST_PTR_FORMAT ", out %" GST_PTR_FORMAT, in, out);
  if (!refused_) announce_latency(out_layers_ ? 0 : frame_latency(out_info_));
  return !refused_;
}

void FilterElement::explain_refusal() {
  if (refused_ || explained_) return;
  const std::string why = untaken_layers(GST_BASE_TRANSFORM_SRC_PAD(element_));
  if (why.empty()) return;
  explained_ = true;
  GST_ELEMENT_ERROR(element_, STREAM, FORMAT, ("%s", why.c_str()), (nullptr));
}

bool FilterElement::try_caps(GstCaps* in, GstCaps* out) {
  const std::string name = info_.factory;
  in_layers_ = carries_layers(in);
  in_images_ = carries_images(in);
  out_layers_ = carries_layers(out);
  if (!info_.takes_pixels() && !in_layers_) {
    const std::string why =
        missing_layers(GST_BASE_TRANSFORM_SINK_PAD(element_), info_.accepts, info_.needs);
    GST_ELEMENT_ERROR(element_, STREAM, FORMAT, ("%s", why.c_str()), ("got %" GST_PTR_FORMAT, in));
    return false;
  }
  const bool takes_one = info_.sink != Flow::pixels && info_.layers[0] != '{';
  if (in_layers_ && takes_one && !carries_kind(in, info_.layers)) {
    GST_ELEMENT_ERROR(element_, STREAM, FORMAT,
                      ("%s needs %s, and these layers are %s; put %s in the place of the element "
                       "that makes them",
                       name.c_str(), contents_of(info_.layers).c_str(),
                       contents_of(kind_of(in)).c_str(), info_.needs),
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
                      ("%s needs progressive video; insert %s before it", name.c_str(),
                       deinterlace_for(in_info_).c_str()),
                      ("got %" GST_PTR_FORMAT, in));
    return false;
  }
  if (!in_layers_ && !guarded(element_, [&] { filter_->check_plain(in_info_, out_info_); }))
    return false;
  check_pixel_aspect_ratio();
  // The state of earlier frames stays: sources of variable rate send such caps again and again.
  if (!refused_ && asked_.same_frames(in, out)) return true;
  return guarded(element_, [&] {
    stop();
    // Refused formats show up here, before any frame.
    if (!in_layers_)
      input_ = in_images_ ? make_image_input(in_info_) : std::make_unique<FrameInput>(in_info_);
    if (!out_layers_)
      output_ = carries_images(out)
                    ? make_image_output(out_info_, in_info_.colorimetry.primaries)
                    : std::make_unique<FrameOutput>(out_info_, in_info_.colorimetry.primaries);
    if (in_images_ || carries_images(out)) context_.find_neighbor();
    if (carries_images(out)) images_device_ = context_.for_images();
    // The first frame of layers and images carries their device.
    if (in_layers_ || in_images_) return;
    const auto device = device_for(nullptr);
    try {
      configure(device);
    } catch (const Error& error) {
      throw with_largest_size(error, device);
    }
  });
}

void FilterElement::check_pixel_aspect_ratio() {
  const std::pair shape{GST_VIDEO_INFO_PAR_N(&in_info_), GST_VIDEO_INFO_PAR_D(&in_info_)};
  if (shape.first == shape.second || !filter_->needs_square_pixels()) return;
  if (std::exchange(reported_ratio_, shape) == shape) return;
  const std::string warning =
      std::string(info_.factory) + " needs square pixels, and these are " +
      std::to_string(shape.first) + ":" + std::to_string(shape.second) +
      ": round objects become ellipses; put videoscale ! video/x-raw,pixel-aspect-ratio=1/1 "
      "before it";
  post_warning(log_, GST_STREAM_ERROR, GST_STREAM_ERROR_FORMAT, "%s", warning.c_str());
}

bool FilterElement::fits(const std::shared_ptr<gpu::Device>& device, Extent in) {
  const auto in_width = static_cast<uint32_t>(GST_VIDEO_INFO_WIDTH(&in_info_));
  const auto out_width = static_cast<uint32_t>(GST_VIDEO_INFO_WIDTH(&out_info_));
  bool made = true;
  try {
    PlanePool(device, in).acquire();
    filter_->configure(device, {std::max(1U, in.width * out_width / in_width), in.height});
  } catch (const std::exception& error) {
    GST_DEBUG_OBJECT(element_, "%ux%u does not fit: %s", in.width, in.height, error.what());
    made = false;
  }
  filter_->release();
  return made;
}

Error FilterElement::with_largest_size(const Error& error,
                                       const std::shared_ptr<gpu::Device>& device) {
  if (error.kind() != ErrorKind::limit) return error;
  // Make room.
  finish_all();
  slots_ = {};
  forget_repeats();
  planes_.reset();
  if (std::exchange(configured_, false)) filter_->release();
  const gpu::Limits& limits = device->limits();
  const uint64_t pixels =
      std::min(limits.storage_buffer_bytes / (4 * sizeof(float)), uint64_t{limits.texel_elements});
  const auto largest = largest_extent(extent_of(in_info_), pixels,
                                      [&](Extent extent) { return fits(device, extent); });
  if (!largest) return error;
  return {ErrorKind::limit, std::string(error.what()) + "; the largest frame of this shape that " +
                                info_.factory + " takes there is " +
                                std::to_string(largest->width) + "x" +
                                std::to_string(largest->height)};
}

}  // namespace inverse
