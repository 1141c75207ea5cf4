// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image_strokes_levels.spv.hpp"
#include "kernels/image_strokes_track.spv.hpp"
#include "stroke.hpp"
#include "stroke_samples.hpp"

namespace inverse {

/// Follows what lies under strokes from frame to frame (track.comp;
/// docs/reference/methods/intrinsicdecomp.md, 14): finds for each the shift, turn and scale by
/// which its surroundings, as they were when it was drawn, are found again. For frames of one size.
class StrokeTracker {
 public:
  enum class State : uint8_t {
    waiting = shaders::image_strokes_track::STATE_WAITING,  ///< nothing to follow: stays as drawn
    followed = shaders::image_strokes_track::STATE_FOLLOWED,
    lost = shaders::image_strokes_track::STATE_LOST,        ///< not found, and not drawn
    outside = shaders::image_strokes_track::STATE_OUTSIDE,  ///< left the frame, and not drawn
  };
  StrokeTracker(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Follows the strokes of `list` into a frame: linear RGB. Strokes that the list before had, too,
  /// go on from where they are; others are as drawn, and from here on followed. What the frame does
  /// not need is skipped by the device.
  void record(gpu::Commands& commands, const StrokesPtr& list, const Plane& frame);
  /// Strokes are as drawn again, from the next frame on.
  void reset() {
    slots_ = {};
    list_.reset();
  }
  Extent extent() const { return extent_; }

  /// Where a stroke's state lies in `poses`, and the point that it turns around, as drawn.
  struct Slot {
    uint32_t index = 0;
    Stroke::Point center{};
  };
  /// Of a stroke of the last list; of one in the scene Slot{}, as it is not followed.
  Slot slot_of(const Stroke& stroke) const;
  /// poses.glsl.
  const gpu::BufferPtr& poses() const { return poses_; }
  const gpu::BufferPtr& moved() const { return moved_; }

  /// What `poses` says of a slot.
  struct Pose {
    std::array<float, 2> turn{1, 0}, shift{};
    State state = State::followed;
    /// Where a point as drawn is now.
    Stroke::Point now(Stroke::Point drawn, Stroke::Point center) const;
    /// The point as drawn that is now at `now`.
    Stroke::Point as_drawn(Stroke::Point now, Stroke::Point center) const;
  };
  static constexpr uint32_t kPoseNumbers = 4 * shaders::image_strokes_track::POSE_STRIDE;
  static Pose read(std::span<const float> poses, uint32_t slot);

 private:
  /// A stroke that is followed.
  struct Followed {
    Stroke stroke;
    Extent frame;
    StrokeSamples samples;
    bool fresh = true, kept = true;
  };
  void take(gpu::Commands& commands, const StrokesPtr& list);
  void write_strokes(gpu::Commands& commands);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  gpu::Program<shaders::image_strokes_levels> halve_frame_, halve_;
  gpu::Program<shaders::image_strokes_track> check_, track_;
  std::array<std::optional<Followed>, kMaxStrokes> slots_;
  StrokesPtr list_;
  uint32_t count_ = 0;
  bool fresh_ = false;  // some are
  std::vector<std::array<float, 4>> sample_table_;
  gpu::BufferPtr strokes_, samples_, poses_, templates_, moved_, pyramid_;
};

}  // namespace inverse
