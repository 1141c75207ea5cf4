// SPDX-License-Identifier: LGPL-2.1-or-later
#include "picture_source.hpp"

#include <algorithm>
#include <cstring>

namespace inverse {

void PictureSource::configure(const std::shared_ptr<gpu::Device>& device, Extent frame) {
  drop();
  device_ = device;
  constexpr uint32_t kMinSide = 256, kMaxSide = 4096;
  max_side_ = std::clamp(2 * std::max(frame.width, frame.height), kMinSide, kMaxSide);
}

void PictureSource::drop() {
  pyramid_.reset();
  info_.reset();
  input_.reset();
  planes_.reset();
  raw_ = {};
  device_.reset();
  changed_ = true;
}

void PictureSource::forget_frames() {
  const std::lock_guard lock(pad_mutex_);
  frame_.reset();
  changed_ = true;
}

void PictureSource::set_file(const std::optional<Picture8>& file) {
  file_ = file;
  changed_ |= !frame_;
}

GstPad* PictureSource::request(GstElement* element, GstPadTemplate* made_from) {
  const std::lock_guard lock(pad_mutex_);
  if (pad_) return nullptr;
  pad_ = TexturePad::create(element, made_from);
  return pad_->pad();
}

void PictureSource::release(GstPad*) {
  const std::lock_guard lock(pad_mutex_);
  pad_.reset();  // the GstPad keeps it
}

bool PictureSource::has_pad() {
  const std::lock_guard lock(pad_mutex_);
  return pad_ != nullptr;
}

bool PictureSource::take(GstClockTime now) {
  const std::lock_guard lock(pad_mutex_);
  if (pad_)
    if (auto frame = pad_->take(now)) {
      frame_ = std::move(frame);
      changed_ = true;
    }
  return has_picture();
}

Plane PictureSource::picture(gpu::Commands& commands, uint64_t frame) {
  if (!frame_) {
    const LinearPicture linear = linear_picture(*file_, max_side_);
    const auto buffer = gpu::Buffer::create(device_, gpu::Element::vec4, linear.extent.pixels(),
                                            gpu::Memory::upload);
    std::memcpy(buffer->map(), linear.rgba.data(), buffer->bytes());
    return {linear.extent, buffer};
  }
  const GstVideoInfo& info = frame_->info;
  if (!info_ || !gst_video_info_is_equal(&*info_, &info)) {
    info_ = info;
    input_ = std::make_unique<FrameInput>(info);
    input_->configure(device_);
    planes_.emplace(device_, Extent{static_cast<uint32_t>(GST_VIDEO_INFO_WIDTH(&info)),
                                    static_cast<uint32_t>(GST_VIDEO_INFO_HEIGHT(&info))});
    raw_ = {};
  }
  const PlanePtr plane = planes_->acquire();
  input_->record(commands, frame_->buffer.get(), raw_[frame], *plane);
  commands.keep(plane);
  return *plane;
}

const TexturePyramid& PictureSource::pyramid(gpu::Commands& commands, uint64_t frame) {
  if (!changed_ && pyramid_) return *pyramid_;
  const Plane plane = picture(commands, frame);
  if (!pyramid_ || pyramid_->extent() != plane.extent) pyramid_.emplace(device_, plane.extent);
  pyramid_->record(commands, plane);
  changed_ = false;
  return *pyramid_;
}

}  // namespace inverse
