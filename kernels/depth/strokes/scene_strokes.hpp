// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "kernels/depth/volume.hpp"
#include "kernels/depth_strokes_close.spv.hpp"
#include "kernels/depth_strokes_grow.spv.hpp"
#include "kernels/depth_strokes_mark.spv.hpp"
#include "kernels/depth_strokes_select.spv.hpp"
#include "kernels/image/strokes/stroke.hpp"

namespace inverse {

/// Strokes in the voxels of a scene (thesis, 4.5): the balls of a stroke mark what is within the
/// truncation of surfaces; one that fills spreads over several frames to what is connected to it
/// and has nearly its reflectance. docs/reference/methods/volume.md, 6.
class SceneStrokes {
 public:
  /// Throws Error(out_of_memory).
  SceneStrokes(const std::shared_ptr<gpu::Device>& device, const Volume& volume);

  /// Has those strokes of a list that are in the scene from the next `record` on; null: none.
  void set(const StrokesPtr& list);
  /// Records what is to be done in a frame. `grown`: the volume may have new voxels since the last
  /// call with it.
  void record(gpu::Commands& commands, Volume& volume, bool grown);
  /// Records closing of the holes of one pixel that strokes have in a view: a word a pixel, as
  /// Volume::View::strokes.
  void record_close(gpu::Commands& commands, const Volume::View& view,
                    const gpu::BufferPtr& closed);
  /// Whether `record` records anything, if the volume has not grown.
  bool busy() const { return changed_ || busy_ > 0; }
  /// By id, from 1 on.
  std::span<const std::optional<Stroke>> strokes() const { return strokes_; }
  bool empty() const { return order_.empty(); }

  /// A word: voxels from which strokes are to spread on.
  const gpu::BufferPtr& state() const { return state_; }
  static constexpr uint64_t kLeftOffset =
      sizeof(uint32_t) *
      (shaders::depth_strokes_grow::FILL_PASSES * shaders::depth_strokes_grow::STATE_STRIDE +
       shaders::depth_strokes_grow::STATE_FRONT);
  /// That this word of a completed frame was `left`.
  void heard(uint32_t left);

 private:
  void write_tables(gpu::Commands& commands);
  void record_marks(gpu::Commands& commands, const Volume& volume);

  gpu::Program<shaders::depth_strokes_select> select_;
  gpu::Program<shaders::depth_strokes_mark> mark_;
  gpu::Program<shaders::depth_strokes_grow> grow_;
  gpu::Program<shaders::depth_strokes_close> close_;
  // Twice as many as strokes: a new one must not have the id of one whose marks are still there.
  static constexpr size_t kIds = 2 * kMaxStrokes;
  std::array<std::optional<Stroke>, kIds> strokes_;  // by id - 1
  std::array<bool, kIds> fresh_{}, marked_ids_{};
  std::vector<uint32_t> order_;  // ids in the order of the list
  bool changed_ = false, fills_ = false;
  uint32_t busy_ = 0;  // frames
  gpu::BufferPtr brushes_, balls_, ids_, marked_, list_, sums_, front_, state_, start_;
};

}  // namespace inverse
