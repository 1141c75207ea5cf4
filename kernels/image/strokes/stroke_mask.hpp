// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/image/tiles/tile_list.hpp"
#include "kernels/image_strokes_commit.spv.hpp"
#include "kernels/image_strokes_draw.spv.hpp"
#include "kernels/image_strokes_place.spv.hpp"
#include "kernels/image_strokes_project.spv.hpp"
#include "kernels/image_strokes_reflectance.spv.hpp"
#include "seen_strokes.hpp"
#include "stroke.hpp"
#include "stroke_fill.hpp"
#include "stroke_tracker.hpp"

namespace inverse {

/// What of a picture strokes cover, drawn where they are now (strokes.glsl). Allocates its buffers
/// when it is first used.
class StrokeMask {
 public:
  StrokeMask(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Where strokes are in a frame.
  struct Places {
    const StrokeTracker* tracker = nullptr;  ///< has found them; null: where they were drawn
    const SeenStrokes* seen = nullptr;       ///< those in the scene; null: not seen
  };
  /// Draws these strokes.
  void set(gpu::Commands& commands, const StrokesPtr& list, const Places& places);
  /// Those that were set last; null: none.
  const StrokesPtr& list() const { return list_; }
  /// Where they follow what they lie on.
  const StrokeTracker* tracker() const { return tracker_; }
  /// Whether they may lie elsewhere in the next frame.
  bool moves() const { return tracker_ || in_scene_; }
  void forget() {
    list_.reset();
    tracker_ = nullptr;
    count_ = 0;
    filled_ = fills_ = in_scene_ = false;
  }
  bool empty() const { return count_ == 0; }
  uint32_t count() const { return count_; }
  /// Whether strokes are yet to be extended to surroundings of similar reflectance.
  bool unfilled() const { return fills_ && !filled_; }
  /// Whether some are to be.
  bool fills() const { return fills_; }
  /// Reflectance of a frame, RGB, a vec4 a pixel; or, if `frame` is set, of the one before: with
  /// these two frames, reflectance with its shading follows.
  struct Reflectance {
    gpu::BufferPtr reflectance, frame_before, frame;
  };
  /// Extends them where they are in this frame.
  void fill(gpu::Commands& commands, const Reflectance& of, const SeenStrokes* seen);
  /// Draws them again if the tracker has moved some in this frame or some are in the scene, and
  /// extends those that `fill` did.
  void follow(gpu::Commands& commands, const Reflectance& of, const SeenStrokes* seen);

  /// Of every pixel, in rows padded to packs of four: 0, or the number of its stroke, from 1 on,
  /// plus half of its weight.
  const gpu::BufferPtr& pixels() const { return mask_; }
  /// Of every stroke, STROKE_STRIDE vec4.
  const gpu::BufferPtr& strokes() const { return strokes_; }
  /// A word at MOVED_STROKES, 0 if no stroke has moved in this frame.
  const gpu::BufferPtr& moved() const;
  /// Of every tile, whether the mask changed there in `follow`.
  const gpu::BufferPtr& changed() const { return changed_; }

 private:
  void take_numbers(gpu::Commands& commands, const SeenStrokes* seen);
  void place(gpu::Commands& commands, const gpu::BufferPtr& mask, const SeenStrokes* seen);
  void extend(gpu::Commands& commands, const gpu::BufferPtr& mask, const Reflectance& of);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  gpu::Program<shaders::image_strokes_place> place_, place_followed_;
  gpu::Program<shaders::image_strokes_draw> draw_;
  gpu::Program<shaders::image_strokes_project> project_;
  gpu::Program<shaders::image_strokes_commit> commit_;
  gpu::Program<shaders::image_strokes_reflectance> reflectance_;
  StrokeFill fill_;
  StrokesPtr list_;
  const StrokeTracker* tracker_ = nullptr;
  uint32_t count_ = 0;
  float step_ = 1;
  bool fills_ = false, filled_ = false, in_scene_ = false;
  std::vector<uint32_t> numbers_;  // project.comp
  gpu::BufferPtr drawn_, depths_, number_table_, always_, strokes_, mask_, next_, changed_,
      reflectance_now_;
};

}  // namespace inverse
