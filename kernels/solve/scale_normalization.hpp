// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/solve_scale_smooth.spv.hpp"
#include "kernels/solve_scale_track.spv.hpp"
#include "kernels/solve_scale_update.spv.hpp"

namespace inverse {

/// The scale c of the output: reflectance R c and shading S / c (scale.glsl). The first frame, and
/// one after a cut, gets the scale `Frame::target`. Later some 400 points are tracked from frame to
/// frame, and c keeps the reflectance that they had two seconds (64 frames) before: what stays in
/// view keeps its brightness, whatever enters or leaves the frame. All of it is on the device.
class ScaleNormalization {
 public:
  /// How a frame is related to the one before.
  enum class History : uint32_t {
    none,     ///< there is none
    decided,  ///< a cut decision is on the device
    taken,    ///< it continues that one for sure
  };
  /// A frame of a solver.
  struct Frame {
    /// vec4: ln c less ln(white level) of the frame alone; 0 if all of it is dark.
    gpu::BufferPtr target;
    gpu::BufferPtr decision;  ///< vec4, with History::decided: its second number is 0 at a cut
    History history = History::none;
    float white_level = 1;  ///< of reflectance, > 0
    /// vec4: slope k of the color of light, m at which it is white, by which the cells' color was
    /// corrected; null: it was not.
    gpu::BufferPtr light;
  };

  /// `cells`: the size of the planes that points are followed on.
  ScaleNormalization(const std::shared_ptr<gpu::Device>& device, Extent cells);

  /// The plane that a solver writes before `record`: vec4 a cell, mean log intensity, two log
  /// ratios of its color, mean log reflectance in the solver's scale.
  const gpu::BufferPtr& cells() const { return input_; }
  /// Records the scale of the frame whose cells were just written.
  void record(gpu::Commands& commands, const Frame& frame);
  /// Records taking over the scale of another size.
  void take(gpu::Commands& commands, const ScaleNormalization& other);
  /// vec4: ln c; 1 once it is known; ln c less ln(white level), of the output and of the last frame
  /// alone.
  const gpu::BufferPtr& value() const { return scale_; }
  /// What `Frame::light` stands for: itself, or gray light if it is null.
  const gpu::BufferPtr& light_of(gpu::Commands& commands, const gpu::BufferPtr& light);

 private:
  void clear_once(gpu::Commands& commands);

  Extent cells_;
  uint32_t columns_, rows_;  // of points
  float spacing_;            // cells from point to point
  gpu::Program<shaders::solve_scale_smooth> smooth_;
  gpu::Program<shaders::solve_scale_track> track_;
  gpu::Program<shaders::solve_scale_update> update_;
  gpu::BufferPtr input_, before_, now_, scale_, points_, moved_points_, history_, samples_;
  gpu::BufferPtr gray_light_;
  uint32_t frames_ = 0;  // that points were followed through
  bool cleared_ = false;
  bool followed_ = false;  // `before_` is of the frame before
};

}  // namespace inverse
