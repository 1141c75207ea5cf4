// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame_io.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string>

#include "gst/base/meta/layers_meta.hpp"
#include "mapped_memory.hpp"
#include "video_format.hpp"

namespace inverse {
namespace {

TransferFunction transfer_function(GstVideoTransferFunction function) {
  switch (function) {
    case GST_VIDEO_TRANSFER_GAMMA10:
      return TransferFunction::linear;
    case GST_VIDEO_TRANSFER_GAMMA18:
      return TransferFunction::gamma18;
    case GST_VIDEO_TRANSFER_GAMMA20:
      return TransferFunction::gamma20;
    case GST_VIDEO_TRANSFER_GAMMA22:
      return TransferFunction::gamma22;
    case GST_VIDEO_TRANSFER_GAMMA28:
      return TransferFunction::gamma28;
    case GST_VIDEO_TRANSFER_BT709:
    case GST_VIDEO_TRANSFER_BT601:
    case GST_VIDEO_TRANSFER_BT2020_10:
    case GST_VIDEO_TRANSFER_BT2020_12:
      return TransferFunction::bt709;
    case GST_VIDEO_TRANSFER_SMPTE240M:
      return TransferFunction::smpte240m;
    case GST_VIDEO_TRANSFER_ADOBERGB:
      return TransferFunction::adobe_rgb;
    case GST_VIDEO_TRANSFER_SMPTE2084:
      return TransferFunction::pq;
    case GST_VIDEO_TRANSFER_ARIB_STD_B67:
      return TransferFunction::hlg;
    case GST_VIDEO_TRANSFER_LOG100:
      return TransferFunction::log100;
    case GST_VIDEO_TRANSFER_LOG316:
      return TransferFunction::log316;
    case GST_VIDEO_TRANSFER_SRGB:
    case GST_VIDEO_TRANSFER_UNKNOWN:
      break;  // what screens and still cameras mean when they do not say
  }
  return TransferFunction::srgb;
}

Matrix color_matrix(GstVideoColorMatrix matrix, bool yuv) {
  switch (matrix) {
    case GST_VIDEO_COLOR_MATRIX_BT601:
      return Matrix::bt601();
    case GST_VIDEO_COLOR_MATRIX_SMPTE240M:
      return Matrix::smpte240m();
    case GST_VIDEO_COLOR_MATRIX_FCC:
      return Matrix::fcc();
    case GST_VIDEO_COLOR_MATRIX_BT2020:
      return Matrix::bt2020();
    case GST_VIDEO_COLOR_MATRIX_RGB:
    case GST_VIDEO_COLOR_MATRIX_UNKNOWN:
      return yuv ? Matrix::bt601() : Matrix{};
    case GST_VIDEO_COLOR_MATRIX_BT709:
      break;
  }
  return Matrix::bt709();
}

/// Whether colors of these primaries reach well beyond BT.709's. The others differ by less than
/// what streams that name no primaries get wrong: GStreamer derives theirs from the size of the
/// picture.
bool is_wide(GstVideoColorPrimaries primaries) {
  switch (primaries) {
    case GST_VIDEO_COLOR_PRIMARIES_BT2020:
    case GST_VIDEO_COLOR_PRIMARIES_ADOBERGB:
    case GST_VIDEO_COLOR_PRIMARIES_SMPTEST428:
    case GST_VIDEO_COLOR_PRIMARIES_SMPTERP431:
    case GST_VIDEO_COLOR_PRIMARIES_SMPTEEG432:
      return true;
    default:
      return false;
  }
}

Primaries primaries_of(GstVideoColorPrimaries primaries) {
  const GstVideoColorPrimariesInfo& p = *gst_video_color_primaries_get_info(primaries);
  return {{p.Rx, p.Ry}, {p.Gx, p.Gy}, {p.Bx, p.By}, {p.Wx, p.Wy}};
}

/// Whether the buffer's GstVideoMeta, if it has one, describes a frame of these caps.
bool suits(const GstVideoInfo& info, GstBuffer* buffer) {
  const GstVideoMeta* meta = gst_buffer_get_video_meta(buffer);
  return !meta || (meta->format == GST_VIDEO_INFO_FORMAT(&info) &&
                   meta->width >= static_cast<guint>(GST_VIDEO_INFO_WIDTH(&info)) &&
                   meta->height >= static_cast<guint>(GST_VIDEO_INFO_HEIGHT(&info)));
}

/// The layout that GStreamer gives frames of these caps, if kernels can use it; else one in which
/// rows are padded to words.
FrameFormat with_layout(FrameFormat format, const GstVideoInfo& info) {
  bool usable = true;
  FrameFormat theirs = format;
  for (uint32_t p = 0; p < format.format.planes; ++p) {
    usable &= info.stride[p] > 0 && info.offset[p] <= UINT32_MAX;
    theirs.offset[p] = static_cast<uint32_t>(info.offset[p]);
    theirs.stride[p] = static_cast<uint32_t>(info.stride[p]);
  }
  return usable && is_word_aligned(theirs) ? theirs : aligned_layout(format, 4);
}

bool has_layout(const FrameFormat& format, const gint* strides, const gsize* offsets) {
  for (uint32_t p = 0; p < format.format.planes; ++p)
    if (strides[p] != static_cast<gint>(format.stride[p]) || offsets[p] != format.offset[p])
      return false;
  return true;
}

/// The words of a frame that lies on `device` as kernels read and write it; null for others.
gpu::BufferPtr mapped_frame(const GstVideoInfo& info, const FrameFormat& format,
                            const gpu::Device& device, GstBuffer* buffer) {
  const gpu::BufferPtr words = mapped_words(buffer);
  if (!words || words->device().get() != &device || !suits(info, buffer) ||
      gst_buffer_get_size(buffer) < GST_VIDEO_INFO_SIZE(&info))
    return nullptr;
  // A single plane is bound by rows, of which there are no more than the frame's.
  const uint64_t needed = raw_words(format);
  if (format.format.planes == 1 ? words->count() != needed : words->count() < needed)
    return nullptr;
  const GstVideoMeta* meta = gst_buffer_get_video_meta(buffer);
  const bool same = meta ? has_layout(format, meta->stride, meta->offset)
                         : has_layout(format, info.stride, info.offset);
  return same ? words : nullptr;
}

/// Whether all rows of a plane lie in the memory that was mapped for it. GStreamer checks only
/// its first byte if strides and offsets come from a GstVideoMeta.
bool holds_rows(const GstVideoFrame& frame, const FrameFormat& format, uint32_t plane) {
  const GstMapInfo& map = frame.map[frame.meta ? plane : 0];
  const auto* begin = static_cast<const uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, plane));
  // A meta that maps memory in its own way is trusted.
  if (!map.data || begin < map.data || begin >= map.data + map.size) return frame.meta != nullptr;
  const auto last = static_cast<int64_t>(GST_VIDEO_FRAME_PLANE_STRIDE(&frame, plane)) *
                    (static_cast<int64_t>(plane_rows(format.format, format.extent, plane)) - 1);
  const int64_t start = begin - map.data;
  const auto row = static_cast<int64_t>(row_bytes(format.format, format.extent, plane));
  return start + std::min<int64_t>(last, 0) >= 0 &&
         start + std::max<int64_t>(last, 0) + row <= static_cast<int64_t>(map.size);
}

/// A mapped GstVideoFrame that unmaps itself. Throws if the buffer does not hold a frame of its
/// caps.
class MappedFrame {
 public:
  MappedFrame(const GstVideoInfo& info, const FrameFormat& format, GstBuffer* buffer,
              GstMapFlags flags) {
    const auto no_ref = static_cast<GstMapFlags>(GST_VIDEO_FRAME_MAP_FLAG_NO_REF);
    bool whole =
        suits(info, buffer) &&
        gst_video_frame_map(&frame_, &info, buffer, static_cast<GstMapFlags>(flags | no_ref));
    if (whole) {
      for (uint32_t plane = 0; plane < format.format.planes; ++plane)
        whole &= holds_rows(frame_, format, plane);
      if (!whole) gst_video_frame_unmap(&frame_);
    }
    if (!whole)
      throw Error(ErrorKind::unsupported,
                  "a buffer of " + std::to_string(gst_buffer_get_size(buffer)) +
                      " bytes cannot hold the " + std::to_string(GST_VIDEO_INFO_WIDTH(&info)) +
                      "x" + std::to_string(GST_VIDEO_INFO_HEIGHT(&info)) + " " +
                      gst_video_format_to_string(GST_VIDEO_INFO_FORMAT(&info)) +
                      " frame of its caps; fix the element that sent it");
  }
  MappedFrame(const MappedFrame&) = delete;
  MappedFrame& operator=(const MappedFrame&) = delete;
  ~MappedFrame() { gst_video_frame_unmap(&frame_); }

  uint8_t* data(uint32_t plane) const {
    return static_cast<uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame_, plane));
  }
  size_t stride(uint32_t plane) const {
    return static_cast<size_t>(GST_VIDEO_FRAME_PLANE_STRIDE(&frame_, plane));
  }

 private:
  GstVideoFrame frame_;
};

}  // namespace

Gamut gamut_of(GstVideoColorPrimaries from, GstVideoColorPrimaries to) {
  constexpr auto kUnknown = GST_VIDEO_COLOR_PRIMARIES_UNKNOWN;
  if (from == kUnknown || to == kUnknown || (!is_wide(from) && !is_wide(to))) return {};
  return gamut_between(primaries_of(from), primaries_of(to));
}

FrameFormat frame_format(const GstVideoInfo& info) {
  FrameFormat format;
  format.format = video_format(GST_VIDEO_INFO_FORMAT(&info));
  format.extent = {static_cast<uint32_t>(GST_VIDEO_INFO_WIDTH(&info)),
                   static_cast<uint32_t>(GST_VIDEO_INFO_HEIGHT(&info))};
  const GstVideoColorimetry& color = info.colorimetry;
  const bool yuv = is_yuv(format.format);
  format.matrix = color_matrix(color.matrix, yuv);
  format.range = color.range == GST_VIDEO_COLOR_RANGE_16_235 ||
                         (color.range == GST_VIDEO_COLOR_RANGE_UNKNOWN && yuv)
                     ? Range::limited
                     : Range::full;
  format.transfer = Transfer::of(transfer_function(color.transfer));
  if (info.chroma_site != GST_VIDEO_CHROMA_SITE_UNKNOWN)
    format.site = {(info.chroma_site & GST_VIDEO_CHROMA_SITE_H_COSITED) != 0,
                   (info.chroma_site & GST_VIDEO_CHROMA_SITE_V_COSITED) != 0};
  for (uint32_t p = 0; p < format.format.planes; ++p)
    if (row_bytes(format.format, format.extent, p) >
        static_cast<uint32_t>(std::abs(info.stride[p])))
      throw Error(ErrorKind::unsupported,
                  "GStreamer's rows of " + std::string(format.format.name) + " have no room for " +
                      std::to_string(format.extent.width) +
                      " pixels; crop to an even width, or insert videoconvert ! "
                      "video/x-raw,format=P010_10LE");
  return with_layout(format, info);
}

GstAllocator* frame_allocator(const GstVideoInfo& info,
                              const std::shared_ptr<gpu::Device>& device) {
  return has_layout(frame_format(info), info.stride, info.offset) ? mapped_allocator(device)
                                                                  : nullptr;
}

bool is_gap(GstBuffer* buffer) {
  return GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_GAP) && gst_buffer_get_size(buffer) == 0 &&
         !layers_of(buffer);
}

FrameInput::FrameInput(const GstVideoInfo& info)
    : info_(info), format_(frame_format(info)), last_frame_(format_.format, format_.extent) {}

gpu::BufferPtr FrameInput::make_buffer(const std::shared_ptr<gpu::Device>& device) const {
  return gpu::Buffer::create_by_rows(device, gpu::Element::word, raw_words(format_),
                                     gpu::Memory::upload);
}

void FrameInput::configure(const std::shared_ptr<gpu::Device>& device) {
  unpack_.emplace(device, format_);
}

bool FrameInput::repeats(GstBuffer* buffer) {
  const MappedFrame frame(info_, format_, buffer, GST_MAP_READ);
  std::array<LastFrame::Rows, 4> planes{};
  const uint32_t count = format_.format.planes;
  for (uint32_t plane = 0; plane < count; ++plane)
    planes[plane] = {frame.data(plane), static_cast<ptrdiff_t>(frame.stride(plane))};
  return last_frame_.repeats(std::span(planes).first(count));
}

void FrameInput::record(gpu::Commands& commands, GstBuffer* buffer, gpu::BufferPtr& raw,
                        const Plane& plane) const {
  if (const auto words = mapped_frame(info_, format_, *commands.device(), buffer)) {
    // Nobody else writes there meanwhile: the buffer is neither writable nor back in its pool.
    commands.keep({gst_buffer_ref(buffer), gst_buffer_unref});
    unpack_->record(commands, words, plane);
    return;
  }
  if (!raw) raw = make_buffer(commands.device());
  load(commands, buffer, raw);
  unpack_->record(commands, raw, plane);
}

void FrameInput::load(gpu::Commands& commands, GstBuffer* buffer, const gpu::BufferPtr& raw) const {
  const MappedFrame frame(info_, format_, buffer, GST_MAP_READ);
  for (uint32_t plane = 0; plane < format_.format.planes; ++plane)
    copy_plane(format_.format, format_.extent, plane, frame.data(plane), frame.stride(plane),
               raw->map_as<uint8_t>() + format_.offset[plane], format_.stride[plane]);
  commands.count_upload(raw->bytes());
}

FrameOutput::FrameOutput(const GstVideoInfo& info, GstVideoColorPrimaries planes, bool linear)
    : info_(info), format_(frame_format(info)) {
  format_.gamut = gamut_of(planes, info.colorimetry.primaries);
  if (linear) format_.transfer = Transfer::of(TransferFunction::linear);
}

gpu::BufferPtr FrameOutput::make_buffer(const std::shared_ptr<gpu::Device>& device) const {
  // Rows of several planes are not one part of a buffer.
  const auto create =
      format_.format.planes == 1 ? gpu::Buffer::create_by_rows : gpu::Buffer::create;
  auto raw = create(device, gpu::Element::word, raw_words(format_), gpu::Memory::readback);
  memset(raw->map(), 0, raw->bytes());  // row padding goes out with the rows
  return raw;
}

void FrameOutput::configure(const std::shared_ptr<gpu::Device>& device) {
  pack_.emplace(device, format_);
}

gpu::BufferPtr FrameOutput::mapped(const gpu::Device& device, GstBuffer* buffer) const {
  if (!gst_buffer_is_writable(buffer) || !gst_buffer_is_all_memory_writable(buffer)) return nullptr;
  return mapped_frame(info_, format_, device, buffer);
}

void FrameOutput::record(gpu::Commands& commands, const Picture& picture, const Layers& layers,
                         const gpu::BufferPtr& raw, GstBuffer* buffer) const {
  if (!picture.plane) throw Error(ErrorKind::internal, "an element drew no picture");
  const PlanePtr& input = layers[Role::input];
  pack_->record(commands,
                {*picture.plane, picture.scalar ? Drawing::Source::shading : Drawing::Source::color,
                 picture.gain, input ? input.get() : nullptr},
                raw);
  store(commands, raw, buffer);
}

void FrameOutput::write(const gpu::BufferPtr& raw, GstBuffer* buffer) const {
  const MappedFrame frame(info_, format_, buffer, GST_MAP_WRITE);
  for (uint32_t plane = 0; plane < format_.format.planes; ++plane)
    copy_plane(format_.format, format_.extent, plane,
               raw->map_as<uint8_t>() + format_.offset[plane], format_.stride[plane],
               frame.data(plane), frame.stride(plane));
}

}  // namespace inverse
