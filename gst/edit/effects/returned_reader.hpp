// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <optional>

#include "gst/base/frames/frame_io.hpp"
#include "kernels/edit/returned.hpp"
#include "kernels/gpu/frame_ring.hpp"
#include "kernels/image/format/convert.hpp"
#include "return_pad.hpp"

namespace inverse {

/// Brings pictures of one layer that came back onto the device, beside those that were sent: made
/// once more from the frame's layers, in the same format, so that they have the same codes. If
/// elements on the way converted or scaled pictures, what was sent is converted as GStreamer's own
/// elements do by default, so that only what else was done to it counts.
class ReturnedReader {
 public:
  /// Records both, `number` is the frame's. The planes stay as they are until the next call.
  /// `element` is what messages name.
  ReturnedPicture record(gpu::Commands& commands, const Layers& layers,
                         const ReturnPad::Picture& picture, uint64_t number, const char* element);

 private:
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent,
                 const std::shared_ptr<const ReturnedFormat>& format);
  /// The layers as they were when the picture was sent.
  Layers layers_sent(const Layers& layers) const;

  struct FreeConverter {
    void operator()(GstVideoConverter* converter) const { gst_video_converter_free(converter); }
  };
  using Raw = gpu::FrameRing<gpu::BufferPtr>;

  std::shared_ptr<gpu::Device> device_;  // what all below is for
  Extent extent_;                        // of the layers
  std::shared_ptr<const ReturnedFormat> format_;
  GstVideoInfo info_{}, sent_info_{};  // with the transfer function that the samples have
  std::optional<FrameOutput> output_;
  std::optional<FrameInput> input_;
  std::optional<Unpack> unpack_;  // if nothing is converted
  std::unique_ptr<GstVideoConverter, FreeConverter> converter_;
  std::unique_ptr<gpu::Commands> commands_;  // of what goes through system memory
  gpu::BufferPtr bytes_;                     // of what was sent
  Raw returned_raw_, sent_raw_;
  std::optional<Plane> sent_, returned_;
  LayerPictures pictures_;
};

}  // namespace inverse
