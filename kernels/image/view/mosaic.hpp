#pragma once
#include <array>
#include <utility>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/format/convert.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/image_view_mosaic.spv.hpp"

namespace inverse {

/// Draws up to four planes at half size into one, in reading order: top left, top right, bottom
/// left, bottom right. Each pixel is the mean, in linear light, of the 2×2 under it; w = 1. Where
/// the size is odd, the left and the top tiles are the larger ones.
class Mosaic {
 public:
  struct Tile {
    const Plane* picture = nullptr;  ///< of the target's extent; null leaves the tile black
    Drawing::Source source = Drawing::Source::color;
    float gain = 1;
  };
  explicit Mosaic(const std::shared_ptr<gpu::Device>& device);
  void record(gpu::Commands& commands, const std::array<Tile, 4>& tiles, const Plane& target) const;
  /// The pixel of the pictures whose 2×2 a pixel of the target shows: the top left one. A place
  /// outside the target stays as it is.
  static std::pair<int, int> shown_at(int x, int y, Extent target);

 private:
  gpu::Program<shaders::image_view_mosaic> kernel_;
};

}  // namespace inverse
