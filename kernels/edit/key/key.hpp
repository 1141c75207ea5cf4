// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <vector>

#include "kernels/edit/compose.hpp"
#include "kernels/edit/selection/grid.hpp"
#include "kernels/edit_key_cells.spv.hpp"
#include "kernels/edit_key_matte.spv.hpp"
#include "kernels/edit_key_measure.spv.hpp"
#include "kernels/edit_key_picture.spv.hpp"
#include "kernels/edit_key_reduce.spv.hpp"
#include "kernels/edit_key_shrink.spv.hpp"
#include "kernels/edit_key_spread.spv.hpp"
#include "kernels/edit_key_trust.spv.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"

namespace inverse {

struct KeyParams {
  /// The screen's hue, linear RGB.
  std::array<float, 3> key{0.0144F, 0.527F, 0.0513F};
  /// Instead of `key`, the hue that prevails at the frame's border.
  bool of_border = false;
  /// Max distance of chromaticity R / mean R from the screen's of pixels that surely show it.
  float tolerance = 0.25F;
  /// Alpha that becomes 0, and that becomes 1.
  float black = 0.05F, white = 0.95F;
  /// Share of the foreground's excess of the screen's hue that becomes gray.
  float despill = 1;
  /// Pixels by which the foreground's edge moves inward; negative: outward.
  float shrink = 0;
  /// The mask is that of the screen.
  bool invert = false;
  /// Share of the screen that goes.
  float strength = 1;
  /// The screen goes only where the mask layer selects, if there is one.
  bool use_mask = true;

  static constexpr float kMaxShrink = 16;
};

/// A foreground before a screen of one paint (tests/reference/edit/key.hpp has the equations).
/// Reflectance, which is even where light on the screen is not, shows where the screen is; from its
/// light there follows that of the screen behind every pixel. Alpha is by color difference in
/// light: exact for mixtures, as of motion blur and of hair thinner than a pixel.
class Key {
 public:
  Key(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// The cells on which light is measured: squares of at least four pixels, so that strands fill
  /// none.
  static CellGrid grid_of(Extent extent);

  /// Writes Role::mask of `layers`, which must have Role::input and Role::model. Does nothing if
  /// strength is 0. Values that are not finite count as 0; `params` are clamped to their ranges.
  void record(gpu::Commands& commands, Layers& layers, const KeyParams& params);
  /// The keyed picture, with straight alpha in w; `over_black`: multiplied by it. `layers` are
  /// those of `record` in this frame; if strength is 0, the frame with its edits.
  PlanePtr draw(gpu::Commands& commands, const Layers& layers, const KeyParams& params,
                bool over_black);
  /// One vec4: the screen's mean reflectance, 1 if a screen was found.
  const gpu::BufferPtr& screen() const { return screen_; }
  /// Forgets the screen of earlier frames.
  void reset() { fresh_ = true; }

 private:
  /// Light on cells, and on coarser and coarser ones.
  struct Level {
    Extent cells;
    gpu::BufferPtr light;
  };
  using Pyramid = std::vector<Level>;
  Pyramid pyramid() const;
  void fill(gpu::Commands& commands, const Pyramid& pyramid);
  PlanePtr shrink(gpu::Commands& commands, const PlanePtr& matte, float radius);

  std::shared_ptr<gpu::Device> device_;
  CellGrid grid_;
  PlanePool planes_;
  Compose compose_;
  gpu::BufferPtr screen_, means_;
  Pyramid behind_, front_;
  PlanePtr matte_;  // of this frame, before it is shrunk and inverted
  PlanePtr shrunk_;
  gpu::Program<shaders::edit_key_trust> trust_;
  gpu::Program<shaders::edit_key_reduce> reduce_;
  gpu::Program<shaders::edit_key_spread> spread_;
  std::array<gpu::Program<shaders::edit_key_measure>, 2> measure_;  // by BORDER
  std::array<gpu::Program<shaders::edit_key_cells>, 2> cells_;      // by FRONT
  std::array<gpu::Program<shaders::edit_key_matte>, 4> mattes_;     // by MATTE + 2 INVERT
  std::array<gpu::Program<shaders::edit_key_shrink>, 4> shrinks_;   // by DOWN + 2 GROW
  // By OVER_BLACK + 2 EDITED + 4 INVERT.
  std::array<gpu::Program<shaders::edit_key_picture>, 8> pictures_;
  std::array<float, 3> key_{};  // of the frame before
  bool of_border_ = false;
  bool fresh_ = true;
};

}  // namespace inverse
