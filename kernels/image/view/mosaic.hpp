// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <utility>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/format/convert.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/image_view_mosaic.spv.hpp"

namespace inverse {

/// Draws up to four planes at half size into one, in reading order: top left, top right, bottom
/// left, bottom right. Each pixel is the mean of 2×2 in linear light; w = 1. If the size is odd,
/// the left and top ones are larger.
class Mosaic {
 public:
  struct Tile {
    const Plane* picture = nullptr;  ///< of the target's extent; null leaves the tile black
    Drawing::Source source = Drawing::Source::color;
    float gain = 1;
  };
  explicit Mosaic(const std::shared_ptr<gpu::Device>& device);
  void record(gpu::Commands& commands, const std::array<Tile, 4>& tiles, const Plane& target) const;
  /// The top left pixel of the 2×2 that a pixel of the target shows. A position outside the target
  /// is returned unchanged.
  static std::pair<int, int> shown_at(int x, int y, Extent target);

 private:
  gpu::Program<shaders::image_view_mosaic> kernel_;
};

}  // namespace inverse
