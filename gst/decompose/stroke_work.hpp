// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "kernels/edit/stroke_recolor.hpp"
#include "kernels/gpu/frame_ring.hpp"
#include "kernels/image/strokes/stroke_tracker.hpp"
#include "stroke_editor.hpp"

namespace inverse {

/// What a decomposer does with its user's strokes, frame by frame: follows them, before its method
/// decomposes the frame, and recolors what they cover afterwards.
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
  /// Of this frame, those that are taken; null: none.
  const StrokesPtr& all() const { return lists_.all; }
  /// Whether some are to be put into a remembered scene, for which `completed` needs its depth.
  bool places() const { return followed_ && lists_.all && StrokeEditor::places(*lists_.all); }
  /// Where those in the scene are in this frame, until its end; null: they are not seen.
  void see(uint64_t number, const SeenStrokes* seen);
  /// What follows the others; null: nothing.
  const StrokeTracker* tracker() const { return follows_ ? &*tracker_ : nullptr; }
  /// After the method: recolors the layers of `frame`.
  void recolor(FrameContext& frame);

  /// A frame of the method is completed; `rms`: of the strokes that it solved with; `view`: what
  /// it saw of a remembered scene.
  void completed(const Log& log, uint64_t number, const std::vector<float>& rms,
                 const std::optional<SceneView>& view);
  /// Adds fields about a completed frame.
  void describe(GstStructure* stats, uint64_t number, const std::vector<float>& rms) const;

 private:
  /// A frame of the method.
  struct Frame {
    StrokeLists lists;
    std::vector<StrokeTracker::Slot> slots;  // of all strokes; empty: none is followed
    gpu::BufferPtr poses;
    bool seen = false;  // those in the scene
  };
  /// Of all strokes of a frame, in their order.
  static std::vector<float> residuals(const Frame& frame, const std::vector<float>& rms);
  static std::vector<StrokePlace> places(const Frame& frame);

  StrokeEditor& editor_;
  std::optional<StrokeTracker> tracker_;  // made when it is first needed: its kernel is a long one
  std::optional<StrokeRecolor> recolor_;
  std::shared_ptr<gpu::Device> device_;
  StrokeLists lists_;
  std::vector<StrokeTracker::Slot> slots_;
  const SeenStrokes* seen_ = nullptr;  // of this frame
  bool follows_ = false;               // in this frame
  bool followed_ = false;              // what the property said for it
  bool recolored_ = false;             // the frame before
  gpu::FrameRing<Frame> frames_;
};

}  // namespace inverse
