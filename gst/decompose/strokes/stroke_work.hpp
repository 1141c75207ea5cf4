// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "gst/decompose/scene_work.hpp"
#include "kernels/edit/strokes/stroke_recolor.hpp"
#include "kernels/edit/strokes/stroke_select.hpp"
#include "kernels/edit_pick.spv.hpp"
#include "kernels/gpu/frame_ring.hpp"
#include "kernels/image/strokes/stroke_tracker.hpp"
#include "stroke_editor.hpp"

namespace inverse {

/// What a decomposer does with its user's strokes, frame by frame: follows them, before its method
/// decomposes the frame, and recolors or selects what they cover afterwards.
class StrokeWork {
 public:
  explicit StrokeWork(StrokeEditor& editor) : editor_(editor) {}

  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent);
  void release();
  void reset();
  /// Whether the next frame's layers would differ from those of a frame that came again.
  bool requested(const StrokeParams& params) const;

  /// Before the method decomposes `frame`, as its frame `number`: takes the strokes and follows
  /// them. Adds warnings about them.
  void take(FrameContext& frame, uint64_t number, const StrokeParams& params, bool mosaic);
  /// Those that the method is to solve with; null: none. It stays the same object while they do.
  const StrokesPtr& solved() const { return lists_.solved; }
  /// Of a remembered scene: its depth, if some are to be put into it.
  SceneWork::Wanted wanted() const {
    return {.strokes = lists_.all,
            .keep_view = followed_ && lists_.all && StrokeEditor::places(*lists_.all),
            .touch = touches_};
  }
  /// Where those in the scene are in this frame, until its end; null: they are not seen.
  void see(uint64_t number, const SeenStrokes* seen);
  /// What follows the others; null: nothing.
  const StrokeTracker* tracker() const { return follows_ ? &*tracker_ : nullptr; }
  /// After the method: picks a color, recolors the layers of `frame`, and adds the mask layer.
  void edit(FrameContext& frame);

  /// A frame of the method is completed; `rms`: of the strokes that it solved with; `view`: what
  /// it saw of a remembered scene.
  void completed(const Log& log, uint64_t number, const std::vector<float>& rms,
                 const std::optional<SceneView>& view);
  /// Adds fields about a completed frame.
  void describe(GstStructure* stats, uint64_t number, const std::vector<float>& rms) const;

 private:
  void pick(FrameContext& frame);
  /// A frame of the method.
  struct Frame {
    StrokeLists lists;
    std::vector<StrokeTracker::Slot> slots;  // of all strokes; empty: none is followed
    gpu::BufferPtr poses;
    bool seen = false;  // those in the scene
    gpu::BufferPtr color;
    bool picks = false;  // that color
  };
  /// Of all strokes of a frame, in their order.
  static std::vector<float> residuals(const Frame& frame, const std::vector<float>& rms);
  static std::vector<StrokePlace> places(const Frame& frame);

  StrokeEditor& editor_;
  std::optional<StrokeTracker> tracker_;  // made when it is first needed: its kernel is a long one
  std::optional<StrokeRecolor> recolor_;
  std::optional<StrokeSelect> select_;
  gpu::Program<shaders::edit_pick> pick_;
  uint64_t number_ = 0;  // the method's, of this frame
  std::shared_ptr<gpu::Device> device_;
  StrokeLists lists_;
  std::vector<StrokeTracker::Slot> slots_;
  const SeenStrokes* seen_ = nullptr;  // of this frame
  bool follows_ = false;               // in this frame
  bool followed_ = false;              // what the property said for it
  bool touches_ = false;               // the same
  bool selects_ = false;               // in this frame: there is a mask layer
  gpu::FrameRing<Frame> frames_;
};

}  // namespace inverse
