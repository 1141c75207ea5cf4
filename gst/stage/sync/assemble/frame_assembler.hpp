// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <memory>

#include "gst/stage/sync/shared/stage_labels.hpp"
#include "gst/stage/sync/shared/sync_params.hpp"

namespace inverse {

/// What becomes of one camera's labeled frames on their way out of lightstagesync. Called by the
/// thread that pushes on the source pad, unless said otherwise. What throws is an element error.
class FrameAssembler {
 public:
  FrameAssembler(GstElement* element, GstPad* src, std::shared_ptr<const StageLabels> labels)
      : element_(element), src_(src), labels_(std::move(labels)) {}
  FrameAssembler(const FrameAssembler&) = delete;
  FrameAssembler& operator=(const FrameAssembler&) = delete;
  virtual ~FrameAssembler() = default;

  /// The caps of frames that come from now on: agrees with what follows on what leaves, and says
  /// so. False if nothing suits.
  virtual bool set_caps(GstCaps* caps);
  /// Takes a buffer; `label` is null if frames without one pass, too.
  virtual GstFlowReturn take(GstBuffer* buffer, const FrameLabel* label);
  /// Nothing more comes of what is held: the program has ended, or the stream has before it.
  virtual GstFlowReturn finish(bool /*program_over*/) { return GST_FLOW_OK; }
  /// A flush: what is held is forgotten. From upstream's thread, while none pushes.
  virtual void forget() {}
  /// Adds what it has to tell to the camera's stats. From any thread.
  virtual void add_stats(GstStructure*) const {}

 protected:
  GstElement* element_;
  GstPad* src_;
  std::shared_ptr<const StageLabels> labels_;
};

/// What the source pads of an element with these parameters can send of frames of `in`. New
/// reference.
GstCaps* assembled_caps(GstCaps* in, SyncParams::Assemble assemble);

}  // namespace inverse
