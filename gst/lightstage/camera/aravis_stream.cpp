// SPDX-License-Identifier: LGPL-2.1-or-later
#include "aravis_stream.hpp"

#include <algorithm>
#include <cstring>

#include "common/error.hpp"

namespace inverse {

/// Receiver of returned frames. Outlives the stream, as buffers may.
struct AravisStream::Lender {
  std::mutex mutex;
  ArvStream* stream = nullptr;  ///< null when it has ended
  uint32_t lent = 0, max_lent = 0;

  struct Loan {
    std::shared_ptr<Lender> lender;
    ArvBuffer* frame;
  };
  static void give_back(gpointer data) {
    const std::unique_ptr<Loan> loan(static_cast<Loan*>(data));
    const std::lock_guard lock(loan->lender->mutex);
    --loan->lender->lent;
    if (loan->lender->stream)
      arv_stream_push_buffer(loan->lender->stream, loan->frame);
    else
      g_object_unref(loan->frame);
  }
};

AravisStream::AravisStream(AravisCamera& camera, const FrameLayout& layout, uint32_t frames,
                           std::function<void()> arrived)
    : layout_(layout), lender_(std::make_shared<Lender>()), arrived_(std::move(arrived)) {
  const std::lock_guard lock(mutex_of(camera.get()));
  AravisError error;
  stream_ =
      ObjectRef<ArvStream>(arv_camera_create_stream(camera.get(), nullptr, nullptr, error.out()));
  error.check("cannot get frames from the camera " + camera.name());
  if (!stream_)
    throw Error(ErrorKind::connection, "cannot get frames from the camera " + camera.name());
  // The system's default buffer is smaller than a frame; it grants as much of this as its limits
  // allow.
  if (ARV_IS_GV_STREAM(stream_.get()))
    g_object_set(stream_.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED,
                 "socket-buffer-size",
                 static_cast<gint>(std::min<size_t>(4 * layout.payload, size_t{1} << 28)), nullptr);
  for (uint32_t i = 0; i < frames; ++i)
    arv_stream_push_buffer(stream_.get(), arv_buffer_new(layout.payload, nullptr));
  lender_->stream = stream_.get();
  lender_->max_lent = frames / 2;
  g_signal_connect_swapped(stream_.get(), "new-buffer",
                           G_CALLBACK(+[](AravisStream* self) { self->arrived_(); }), this);
  arv_stream_set_emit_signals(stream_.get(), TRUE);
}

AravisStream::~AravisStream() {
  {
    const std::lock_guard lock(lender_->mutex);
    lender_->stream = nullptr;
  }
  arv_stream_set_emit_signals(stream_.get(), FALSE);
  stream_.reset();  // ends its thread, which calls `arrived_`
}

std::optional<CameraFrame> AravisStream::take(const std::function<bool(int64_t age)>& stale) {
  while (ArvBuffer* frame = arv_stream_try_pop_buffer(stream_.get())) {
    CameraFrame result;
    result.id = arv_buffer_get_frame_id(frame);
    result.camera_time = arv_buffer_get_timestamp(frame);
    const auto began = static_cast<int64_t>(arv_buffer_get_system_timestamp(frame));
    result.age = g_get_real_time() * 1000 - began;
    // The machine's clock was set in between.
    if (began <= 0 || result.age < 0 || result.age > 3600 * GST_SECOND) result.age = 0;
    if (arv_buffer_get_status(frame) != ARV_BUFFER_STATUS_SUCCESS)
      ++counts_.incomplete;
    else if (stale(result.age))
      ++counts_.stale;
    else if ((result.pixels = pixels(frame)))
      return result;
    else
      ++counts_.misfits;
    arv_stream_push_buffer(stream_.get(), frame);
  }
  return std::nullopt;
}

/// The pixels of a frame, which is then lent or returned to the stream; null if it does not fit the
/// caps.
GstBuffer* AravisStream::pixels(ArvBuffer* frame) {
  const ArvBufferPayloadType type = arv_buffer_get_payload_type(frame);
  if (type != ARV_BUFFER_PAYLOAD_TYPE_IMAGE && type != ARV_BUFFER_PAYLOAD_TYPE_MULTIPART &&
      type != ARV_BUFFER_PAYLOAD_TYPE_EXTENDED_CHUNK_DATA)
    return nullptr;
  size_t bytes = 0;
  const auto* from = static_cast<const uint8_t*>(arv_buffer_get_image_data(frame, &bytes));
  int padding = 0;
  arv_buffer_get_image_padding(frame, &padding, nullptr);
  const size_t pitch = layout_.row_bytes + static_cast<size_t>(std::max(padding, 0));
  if (!from || arv_buffer_get_image_pixel_format(frame) != layout_.pixel_format ||
      arv_buffer_get_image_width(frame) != static_cast<int>(layout_.width) ||
      arv_buffer_get_image_height(frame) != static_cast<int>(layout_.height) ||
      bytes < pitch * (layout_.height - 1) + layout_.row_bytes)
    return nullptr;

  const size_t size = layout_.stride * layout_.height;
  const bool as_it_is = pitch == layout_.stride && bytes >= size && layout_.shift == 0;
  if (as_it_is) {
    const std::lock_guard lock(lender_->mutex);
    if (lender_->lent < lender_->max_lent) {
      ++lender_->lent;
      ++counts_.lent;
      return gst_buffer_new_wrapped_full(static_cast<GstMemoryFlags>(0), const_cast<uint8_t*>(from),
                                         bytes, 0, size, new Lender::Loan{lender_, frame},
                                         Lender::give_back);
    }
  }
  GstBuffer* copy = gst_buffer_new_allocate(nullptr, size, nullptr);
  GstMapInfo map;
  if (!copy || !gst_buffer_map(copy, &map, GST_MAP_WRITE)) {
    if (copy) gst_buffer_unref(copy);
    throw Error(ErrorKind::out_of_memory, "out of memory for frames of the camera");
  }
  for (uint32_t y = 0; y < layout_.height; ++y) {
    uint8_t* to = map.data + y * layout_.stride;
    if (layout_.shift) {
      for (uint32_t x = 0; x < layout_.width; ++x) {
        const uint8_t* value = from + y * pitch + 2 * size_t{x};
        const uint32_t low = value[0] | uint32_t{value[1]} << 8;
        const uint32_t full =
            std::min<uint32_t>(low << layout_.shift | low >> (16 - 2 * layout_.shift), 65535);
        to[2 * size_t{x}] = static_cast<uint8_t>(full);
        to[2 * size_t{x} + 1] = static_cast<uint8_t>(full >> 8);
      }
    } else {
      memcpy(to, from + y * pitch, layout_.row_bytes);
    }
    memset(to + layout_.row_bytes, 0, layout_.stride - layout_.row_bytes);
  }
  gst_buffer_unmap(copy, &map);
  ++counts_.copied;
  arv_stream_push_buffer(stream_.get(), frame);
  return copy;
}

uint32_t AravisStream::lent_now() const {
  const std::lock_guard lock(lender_->mutex);
  return lender_->lent;
}

AravisStream::Counts AravisStream::counts() const {
  Counts counts = counts_;
  guint64 underruns = 0;
  arv_stream_get_statistics(stream_.get(), nullptr, nullptr, &underruns);
  counts.underruns = underruns;
  if (ARV_IS_GV_STREAM(stream_.get())) {
    guint64 resent = 0, missing = 0;
    arv_gv_stream_get_statistics(ARV_GV_STREAM(stream_.get()), &resent, &missing);
    counts.resent_packets = resent;
    counts.missing_packets = missing;
  }
  return counts;
}

}  // namespace inverse
