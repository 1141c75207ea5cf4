// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "scene_work.hpp"
#include "strokes/stroke_properties.hpp"
#include "strokes/stroke_work.hpp"

namespace inverse {

/// What users set of their strokes and of the remembered scene.
struct InteractionParams : StrokeParams, SceneParams {};

/// The properties of InteractionParams.
template <typename P>
PropertyTable<P> interaction_properties() {
  PropertyTable<P> all = stroke_properties<P>();
  all.append(scene_properties<P>());
  return all;
}

/// What users do with a decomposer: strokes, by the mouse, by touch or by a property, and the scene
/// that it remembers. For each frame a method calls `before`, decomposes, and calls `after`; once
/// the device is done with the frame, `completed`.
class Interaction {
 public:
  /// What a method is to respect in a frame.
  struct Known {
    StrokesPtr strokes;  ///< to solve with; null: none. The same object while they are the same
    const StrokeTracker* tracker = nullptr;         ///< what follows them; null: they stay
    const SeenStrokes* seen = nullptr;              ///< those in the scene; null: not seen
    const KnownReflectance* reflectance = nullptr;  ///< of the remembered scene; null: none
  };

  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent, const Log& log);
  void release();
  void reset() { stroke_work_.reset(); }
  /// Whether the next frame's layers would differ from those of a frame that came again.
  bool requested(const InteractionParams& params) const {
    return stroke_work_.requested(params) || scene_->requested();
  }

  /// `number`: the method's, of `frame`. `mosaic`: several layers are shown side by side. Adds
  /// warnings.
  Known before(FrameContext& frame, uint64_t number, const InteractionParams& params, bool mosaic);
  /// The method has filled the frame's layers.
  void after(FrameContext& frame);
  /// `rms`: deviations that the method found of the strokes that it solved with.
  void completed(uint64_t number, const std::vector<float>& rms, const InteractionParams& params);
  /// Adds fields about a completed frame.
  void describe(GstStructure* stats, uint64_t number, const std::vector<float>& rms) const;

  /// From any thread: the mouse, and what the action signals do.
  void navigate(const Log& log, const MouseEvent& event, const InteractionParams& params) {
    strokes_.mouse(log, event, params);
  }
  StrokeEditor& strokes() { return strokes_; }
  SceneWork& scene() { return *scene_; }

  void flushed() { strokes_.flush(); }
  void ended(const InteractionParams& params) { scene_->ended(params.scene_location); }

 private:
  std::optional<Log> log_;
  StrokeEditor strokes_;
  StrokeWork stroke_work_{strokes_};
  std::unique_ptr<SceneWork> scene_ = make_scene_work();
};

/// The action signals of a decomposer whose method has DecompositionMethod::interaction:
/// add-stroke, remove-stroke, clear-strokes, undo-stroke, and if scenes are remembered save-scene
/// and forget-scene.
std::vector<Action> interaction_actions();

}  // namespace inverse
