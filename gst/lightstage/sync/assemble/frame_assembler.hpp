// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <memory>

#include "gst/lightstage/sync/shared/stage_labels.hpp"
#include "gst/lightstage/sync/shared/sync_params.hpp"

namespace inverse {

/// Combines one camera's labeled frames for the output of lightstagesync. Called by the thread of
/// the source pad, unless said otherwise. What it throws becomes an element error.
class FrameAssembler {
 public:
  FrameAssembler(GstElement* element, GstPad* src, std::shared_ptr<const StageLabels> labels)
      : element_(element), src_(src), labels_(std::move(labels)) {}
  FrameAssembler(const FrameAssembler&) = delete;
  FrameAssembler& operator=(const FrameAssembler&) = delete;
  virtual ~FrameAssembler() = default;

  /// Sets the caps of the following frames: negotiates the output's caps with downstream. False if
  /// there are none.
  virtual bool set_caps(GstCaps* caps);
  /// A buffer; `label` is null for an unlabeled frame that passes.
  virtual GstFlowReturn take(GstBuffer* buffer, const FrameLabel* label);
  /// Ends what is incomplete: the program has ended, or the stream before it.
  virtual GstFlowReturn finish(bool /*program_over*/) { return GST_FLOW_OK; }
  /// Upstream drains: copies frames that are held, whose memory is upstream's.
  virtual void return_buffers() {}
  /// A flush: drops frames. From upstream's thread, while none pushes.
  virtual void forget() {}
  /// Adds fields to the camera's stats. From any thread.
  virtual void add_stats(GstStructure*) const {}

 protected:
  GstElement* element_;
  GstPad* src_;
  std::shared_ptr<const StageLabels> labels_;
};

/// Possible caps of the source pads of an element with these parameters, for frames of `in`. New
/// reference.
GstCaps* assembled_caps(GstCaps* in, SyncParams::Assemble assemble);

}  // namespace inverse
