// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <atomic>
#include <optional>
#include <string>

#include "effects/sent_picture.hpp"
#include "gst/base/frames/frame_io.hpp"
#include "layer_pictures.hpp"

namespace inverse {

/// One pad of intrinsicsplit with all that it takes to send a layer through it. Apart from
/// `released`, everything is the streaming thread's.
class SplitBranch {
 public:
  /// `base` is the base color of SplitLayer::bounced.
  SplitBranch(GstPad* pad, SplitLayer layer, uint32_t base);
  SplitBranch(const SplitBranch&) = delete;
  SplitBranch& operator=(const SplitBranch&) = delete;
  ~SplitBranch();

  /// The name of the template of pads that send `layer`.
  static const char* template_of(SplitLayer layer);
  /// What such a pad can send if layers of these caps come in (template: ANY). New reference.
  static GstCaps* caps_for(SplitLayer layer, const GstCaps* layers);

  GstPad* pad() const { return pad_; }
  SplitLayer layer() const { return layer_; }
  /// The pad's own name.
  std::string name() const;

  /// Agrees with what follows on how to send layers of these caps, sends the caps and takes a
  /// buffer pool. Throws Error(unsupported) if nothing suits.
  void negotiate(const GstCaps* layers, const SplitParams& params);
  bool negotiated() const { return output_.has_value(); }
  /// Forgets what was agreed on.
  void forget();

  /// Records drawing the layer. Throws Error(unsupported) if the frame has no such layer.
  void record(gpu::Commands& commands, const Layers& layers, LayerPictures& pictures,
              const SplitParams& params);
  /// Tells intrinsiccompose ahead of a frame how its picture was made (SentPicture), if that
  /// changed. `edited`: an editor before had changed the layers.
  void announce(const SplitParams& params, bool edited);
  /// Once the commands are done: the drawn frame as a buffer with the times, flags and descriptions
  /// of `source`. `buffer` is set only if GST_FLOW_OK is returned.
  GstFlowReturn take(GstBuffer* source, GstBuffer** buffer);

  bool stream_started = false;       ///< stream-start went out
  bool fed = false;                  ///< a frame went out since the start or a flush
  bool refused = false;              ///< negotiation failed, and an error was posted
  GstFlowReturn flow = GST_FLOW_OK;  ///< of the last push
  std::atomic<bool> released{false};

 private:
  void choose_pool(GstCaps* caps);
  void drop_pool();

  GstPad* pad_;
  SplitLayer layer_;
  uint32_t base_;
  GstVideoInfo info_;
  GstVideoColorPrimaries primaries_ = GST_VIDEO_COLOR_PRIMARIES_UNKNOWN;  // of the layers
  std::optional<SentPicture> announced_;
  std::optional<FrameOutput> output_;
  gpu::BufferPtr readback_;  // null until the device is known
  GstBufferPool* pool_ = nullptr;
};

}  // namespace inverse
