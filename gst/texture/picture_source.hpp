// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <mutex>
#include <optional>

#include "gst/base/frames/frame_io.hpp"
#include "gst/base/pads/side_pads.hpp"
#include "gst/base/pictures/picture_file.hpp"
#include "kernels/gpu/frame_ring.hpp"
#include "kernels/texture/texture_pyramid.hpp"
#include "texture_pad.hpp"

namespace inverse {

/// The picture that hangs, on the device: that of a file, or the frames of a pad from its first one
/// on.
class PictureSource : public SidePads {
 public:
  void configure(const std::shared_ptr<gpu::Device>& device, Extent frame);
  /// Drops everything on the device.
  void drop();
  /// Another run begins: the frames of the last one are gone.
  void forget_frames();
  /// Null: none.
  void set_file(const std::optional<Picture8>& file);

  GstPad* request(GstElement* element, GstPadTemplate* made_from) override;
  void release(GstPad* pad) override;

  /// Takes what the pad has for this running time; whether there is a picture.
  bool take(GstClockTime now);
  bool has_picture() const { return frame_ || file_; }
  bool has_pad();
  /// Records bringing the picture to the device, if it is another one. There must be one.
  const TexturePyramid& pyramid(gpu::Commands& commands, uint64_t frame);

 private:
  Plane picture(gpu::Commands& commands, uint64_t frame);

  std::shared_ptr<gpu::Device> device_;
  uint32_t max_side_ = 0;
  std::optional<Picture8> file_;
  std::mutex pad_mutex_;
  std::shared_ptr<TexturePad> pad_;
  std::optional<TexturePad::Frame> frame_;  // taken last
  bool changed_ = true;                     // since the pyramid was made
  std::optional<TexturePyramid> pyramid_;

  std::optional<GstVideoInfo> info_;  // of input_
  std::unique_ptr<FrameInput> input_;
  std::optional<PlanePool> planes_;
  gpu::FrameRing<gpu::BufferPtr> raw_;
};

}  // namespace inverse
