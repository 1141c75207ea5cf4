// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/intrinsic_light_color_decide.spv.hpp"
#include "kernels/intrinsic_light_color_features.spv.hpp"
#include "kernels/intrinsic_light_color_levels.spv.hpp"
#include "kernels/intrinsic_light_color_move.spv.hpp"
#include "kernels/intrinsic_light_color_points.spv.hpp"
#include "kernels/intrinsic_light_color_scene.spv.hpp"
#include "kernels/intrinsic_light_color_steps.spv.hpp"
#include "kernels/intrinsic_light_color_votes.spv.hpp"
#include "kernels/intrinsic_light_color_white.spv.hpp"

namespace inverse {

/// The color of a scene's light, one number: its slope (image/light_color.glsl;
/// docs/reference/methods/intrinsicdecomp.md, 13), and where light is white. All of it is on the
/// device.
class SceneLight {
 public:
  static constexpr float kMaxSlope = 2;
  struct Params {
    /// Step of ln R/B of light with a step of its ln brightness, −kMaxSlope…kMaxSlope; 0: gray
    /// light; empty: measured in the frames.
    std::optional<float> slope;
    bool colored() const { return slope != 0.0F; }
    bool operator==(const Params&) const = default;
  };
  /// What was done in a frame.
  enum class Did : uint32_t {
    measured = shaders::intrinsic_light_color_scene::LIGHT_MEASURED,
    reused = shaders::intrinsic_light_color_scene::LIGHT_REUSED,
    no_color = shaders::intrinsic_light_color_scene::LIGHT_NO_COLOR,
    no_contrast = shaders::intrinsic_light_color_scene::LIGHT_NO_CONTRAST
  };

  /// Why work on it was skipped in a frame, as in Plan; empty if it was not.
  static std::string skipped(const Params& params, Did did);

  /// `extent` of frames.
  SceneLight(const std::shared_ptr<gpu::Device>& device, Extent extent);
  /// Records the measurement of the light of a frame, linear RGB. `first`: it has no relation to
  /// the frame before. The slope is measured every kPeriod frames, in a new scene, and if none was
  /// yet.
  void record(gpu::Commands& commands, const gpu::BufferPtr& frame, const Params& params,
              bool first);
  /// The next frame has no relation to those so far: frames between are not recorded.
  void restart() { frames_ = 0; }
  /// Records taking that over for the frame, unless it reuses the light of the frame before. The
  /// first call for a frame decides: that of the solver whose layers are shown.
  void record_move(gpu::Commands& commands, bool reuses = false);
  /// Of the frame recorded last (light.glsl).
  const gpu::BufferPtr& state() const { return light_; }
  /// What the layers of that frame carry, one vec4 (Role::slope). `scale`:
  /// ScaleNormalization::value of the layers.
  PlanePtr record_slope(gpu::Commands& commands, const gpu::BufferPtr& scale);

  static constexpr uint32_t kPeriod = 8;
  /// Weights of the network (light.glsl), fitted by training/intrinsic.
  static std::span<const float> weights();

 private:
  void measure(gpu::Commands& commands, const gpu::BufferPtr& frame);

  Extent extent_, cells_;
  uint32_t factor_;          // pixels along a cell
  uint32_t count_, coarse_;  // points of all levels, and of those but the first
  uint32_t frames_ = 0;      // since the last first one; 0: the next one is
  bool decided_ = false;     // whether light moves in this frame
  gpu::Program<shaders::intrinsic_light_color_points> points_kernel_;
  gpu::Program<shaders::intrinsic_light_color_levels> levels_;
  gpu::Program<shaders::intrinsic_light_color_scene> scene_;
  gpu::Program<shaders::intrinsic_light_color_steps> steps_;
  gpu::Program<shaders::intrinsic_light_color_features> features_kernel_;
  gpu::Program<shaders::intrinsic_light_color_votes> votes_;
  gpu::Program<shaders::intrinsic_light_color_decide> decide_;
  gpu::Program<shaders::intrinsic_light_color_move> move_;
  gpu::Program<shaders::intrinsic_light_color_white> white_;
  gpu::BufferPtr probe_, points_, coarse_points_, cloud_, counts_, features_, hidden_, weights_;
  gpu::BufferPtr arguments_, light_;
  PlanePool slopes_;
};

}  // namespace inverse
