// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <memory>
#include <optional>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/format/convert.hpp"
#include "kernels/image/format/last_frame.hpp"
#include "kernels/image/layers.hpp"
#include "picture.hpp"

namespace inverse {

/// Between colors of these primaries: the identity if one is unknown, or neither is wider than
/// BT.709.
Gamut gamut_of(GstVideoColorPrimaries from, GstVideoColorPrimaries to);

/// The layout of a frame in memory, as kernels/image describes it. Throws Error(unsupported), which
/// names the format or colorimetry, if it cannot be handled.
FrameFormat frame_format(const GstVideoInfo& info);

/// An allocator for frames of these caps that kernels read and write where they lie
/// (mapped_allocator); null if GStreamer lays them out in another way. New reference.
/// Throws as frame_format.
GstAllocator* frame_allocator(const GstVideoInfo& info, const std::shared_ptr<gpu::Device>& device);

/// Whether a buffer stands for a missing frame: flagged GAP and empty, without layers.
bool is_gap(GstBuffer* buffer);

/// From a buffer to a linear plane. This class reads system memory; derived classes read other
/// memory.
class FrameInput {
 public:
  explicit FrameInput(const GstVideoInfo& info);
  FrameInput(const FrameInput&) = delete;
  FrameInput& operator=(const FrameInput&) = delete;
  virtual ~FrameInput() = default;

  /// The device on which a frame lies already; null if it can be brought to any.
  virtual std::shared_ptr<gpu::Device> device_of(GstElement*, GstBuffer*) { return nullptr; }
  /// A buffer for the bytes of one frame on the device, for `record`.
  virtual gpu::BufferPtr make_buffer(const std::shared_ptr<gpu::Device>& device) const;
  void configure(const std::shared_ptr<gpu::Device>& device);
  /// Whether all bytes are those of the frame that was asked for before (LastFrame); false if the
  /// pixels are not in system memory. Throws as `record`.
  virtual bool repeats(GstBuffer* buffer);
  /// The next frame has none before it to be compared with.
  void forget() { last_frame_.reset(); }
  /// Records the conversion of `buffer` into `plane`. Holds a frame that lies on the device
  /// (frame_allocator) until the work is done; brings others into `raw`, which must be idle, and is
  /// made if null. Throws Error(unsupported) if the buffer does not match its caps.
  void record(gpu::Commands& commands, GstBuffer* buffer, gpu::BufferPtr& raw,
              const Plane& plane) const;

 protected:
  /// Copies the bytes at once, or records copying them.
  virtual void load(gpu::Commands& commands, GstBuffer* buffer, const gpu::BufferPtr& raw) const;

  GstVideoInfo info_;
  FrameFormat format_;  // on the device

 private:
  std::optional<Unpack> unpack_;
  LastFrame last_frame_;
};

/// From planes to a buffer, in system memory unless a derived class writes other memory.
class FrameOutput {
 public:
  /// `planes` are the primaries of the planes that are drawn: colors are converted if they, or the
  /// caps', are wider than BT.709. `linear` writes linear light whatever the caps' transfer curve
  /// is.
  explicit FrameOutput(const GstVideoInfo& info,
                       GstVideoColorPrimaries planes = GST_VIDEO_COLOR_PRIMARIES_UNKNOWN,
                       bool linear = false);
  FrameOutput(const FrameOutput&) = delete;
  FrameOutput& operator=(const FrameOutput&) = delete;
  virtual ~FrameOutput() = default;

  /// A buffer for the bytes of one frame on the device, for `record` and `write`.
  virtual gpu::BufferPtr make_buffer(const std::shared_ptr<gpu::Device>& device) const;
  void configure(const std::shared_ptr<gpu::Device>& device);
  /// The memory of `buffer`, for `record`, if it is on the device (frame_allocator) and writable;
  /// null otherwise. `write` must not follow.
  gpu::BufferPtr mapped(const gpu::Device& device, GstBuffer* buffer) const;
  /// Records drawing `picture` into `raw` and on to `buffer`, as far as the device does that. Alpha
  /// comes from the input layer's w if there is one.
  void record(gpu::Commands& commands, const Picture& picture, const Layers& layers,
              const gpu::BufferPtr& raw, GstBuffer* buffer) const;
  /// Whether `write` has to follow, once the commands are done.
  virtual bool waits() const { return true; }
  /// Copies what was drawn into a writable buffer.
  virtual void write(const gpu::BufferPtr& raw, GstBuffer* buffer) const;

 protected:
  /// Records the way of the bytes from `raw` to `buffer`; nothing for system memory.
  virtual void store(gpu::Commands&, const gpu::BufferPtr&, GstBuffer*) const {}

  GstVideoInfo info_;
  FrameFormat format_;

 private:
  std::optional<Pack> pack_;
};

}  // namespace inverse
