// SPDX-License-Identifier: LGPL-2.1-or-later
#include "returned_reader.hpp"

#include <string>

#include "common/error.hpp"

namespace inverse {
namespace {

Extent extent_of(const GstVideoInfo& info) {
  return {static_cast<uint32_t>(GST_VIDEO_INFO_WIDTH(&info)),
          static_cast<uint32_t>(GST_VIDEO_INFO_HEIGHT(&info))};
}

Plane make_plane(const std::shared_ptr<gpu::Device>& device, Extent extent) {
  return {extent, gpu::Buffer::create_by_rows(device, gpu::Element::vec4, extent.pixels(),
                                              gpu::Memory::device)};
}

ReturnedPicture::Layer layer_of(SplitLayer layer) {
  using Layer = ReturnedPicture::Layer;
  switch (layer) {
    case SplitLayer::reflectance:
      return Layer::reflectance;
    case SplitLayer::direct:
      return Layer::direct;
    case SplitLayer::indirect:
      return Layer::indirect;
    case SplitLayer::mask:
      return Layer::mask;
    default:
      return Layer::shading;
  }
}

/// As videoconvert and videoscale convert by default.
GstVideoConverter* new_converter(const GstVideoInfo& from, const GstVideoInfo& to) {
  return gst_video_converter_new(
      &from, &to,
      gst_structure_new("options", GST_VIDEO_CONVERTER_OPT_RESAMPLER_METHOD,
                        GST_TYPE_VIDEO_RESAMPLER_METHOD, GST_VIDEO_RESAMPLER_METHOD_LINEAR,
                        GST_VIDEO_RESAMPLER_OPT_MAX_TAPS, G_TYPE_INT, 2, nullptr));
}

struct UnrefBuffer {
  void operator()(GstBuffer* buffer) const { gst_buffer_unref(buffer); }
};
using BufferPtr = std::unique_ptr<GstBuffer, UnrefBuffer>;

BufferPtr converted(GstVideoConverter* converter, const GstVideoInfo& from, GstBuffer* buffer,
                    const GstVideoInfo& to) {
  BufferPtr made(gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&to), nullptr));
  GstVideoFrame in, out;
  if (!gst_video_frame_map(&in, &from, buffer, GST_MAP_READ))
    throw Error(ErrorKind::internal, "a picture cannot be read");
  if (!gst_video_frame_map(&out, &to, made.get(), GST_MAP_WRITE)) {
    gst_video_frame_unmap(&in);
    throw Error(ErrorKind::internal, "a picture cannot be written");
  }
  gst_video_converter_frame(converter, &in, &out);
  gst_video_frame_unmap(&out);
  gst_video_frame_unmap(&in);
  return made;
}

}  // namespace

void ReturnedReader::configure(const std::shared_ptr<gpu::Device>& device, Extent extent,
                               const std::shared_ptr<const ReturnedFormat>& format) {
  if (device_ == device && format_ == format && extent_ == extent) return;
  format_.reset();
  info_ = format->info;
  sent_info_ = format->sent.info;
  if (extent_of(sent_info_) != extent) {
    const GstVideoInfo like = sent_info_;
    gst_video_info_set_format(&sent_info_, GST_VIDEO_INFO_FORMAT(&like), extent.width,
                              extent.height);
    sent_info_.colorimetry = like.colorimetry;
    sent_info_.chroma_site = like.chroma_site;
  }
  // What converters insist on, and pictures do not depend on.
  sent_info_.fps_n = info_.fps_n;
  sent_info_.fps_d = info_.fps_d;
  sent_info_.interlace_mode = info_.interlace_mode;
  // Whatever curve the caps name.
  if (format->sent.linear())
    info_.colorimetry.transfer = sent_info_.colorimetry.transfer = GST_VIDEO_TRANSFER_GAMMA10;
  output_.emplace(sent_info_, format->sent.primaries);
  output_->configure(device);
  input_.emplace(info_);
  input_->configure(device);
  unpack_.reset();
  converter_.reset();
  if (same_pictures(info_, sent_info_)) {
    const FrameFormat layout = frame_format(sent_info_);
    unpack_.emplace(device, layout);
    const auto create =
        layout.format.planes == 1 ? gpu::Buffer::create_by_rows : gpu::Buffer::create;
    bytes_ = create(device, gpu::Element::word, raw_words(layout), gpu::Memory::device);
  } else {
    converter_.reset(new_converter(sent_info_, info_));
    if (!converter_)
      throw Error(ErrorKind::unsupported,
                  std::string("GStreamer cannot convert ") +
                      gst_video_format_to_string(GST_VIDEO_INFO_FORMAT(&sent_info_)) + " to " +
                      gst_video_format_to_string(GST_VIDEO_INFO_FORMAT(&info_)) +
                      "; insert videoconvert behind the effect");
    bytes_ = output_->make_buffer(device);
    commands_ = std::make_unique<gpu::Commands>(device);
  }
  returned_raw_ = sent_raw_ = {};
  const Extent size = extent_of(info_);
  sent_ = make_plane(device, size);
  returned_ = make_plane(device, size);
  device_ = device;
  extent_ = extent;
  format_ = format;
}

Layers ReturnedReader::layers_sent(const Layers& layers) const {
  Layers sent = layers;
  if (!format_->sent.edited) {
    sent[Role::intrinsic] = layers[Role::model];
    sent[Role::light] = layers[Role::model_light];
  }
  return sent;
}

ReturnedPicture ReturnedReader::record(gpu::Commands& commands, const Layers& layers,
                                       const ReturnPad::Picture& picture, uint64_t number,
                                       const char* element) {
  configure(commands.device(), layers.extent, picture.format);
  const SentPicture& sent = format_->sent;
  const Layers source = layers_sent(layers);
  gpu::Commands& drawing = converter_ ? *commands_ : commands;
  if (converter_) drawing.begin();
  const Picture drawn = pictures_.draw(drawing, source, sent.layer, sent.params, element);
  output_->record(drawing, drawn, source, bytes_, nullptr);
  if (converter_) {
    drawing.submit();
    drawing.wait();
    const BufferPtr before(
        gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&sent_info_), nullptr));
    output_->write(bytes_, before.get());
    const BufferPtr after = converted(converter_.get(), sent_info_, before.get(), info_);
    input_->record(commands, after.get(), sent_raw_[number], *sent_);
  } else {
    unpack_->record(commands, bytes_, *sent_);
  }
  input_->record(commands, picture.buffer.get(), returned_raw_[number], *returned_);
  return {.layer = layer_of(sent.layer),
          .sent = *sent_,
          .returned = *returned_,
          .gain = sent.gain(),
          .gray = static_cast<bool>(GST_VIDEO_INFO_IS_GRAY(&info_)),
          .gamut = gamut_of(info_.colorimetry.primaries, sent.primaries)};
}

}  // namespace inverse
