// What the truth says about base colors (thesis, chapter 5): which pixels were taken for a wrong
// one, where somebody who sees that would click, and how far base colors are from the paint.
#pragma once

#include <span>
#include <vector>

#include "kernels/global_thesis/base_colors.hpp"
#include "tests/bench/image.hpp"

namespace inverse::bench {

/// For every pixel the slot of the base color whose center is nearest to the true reflectance, in
/// ln chromaticity, as pixels of a frame are assigned; −1 where the truth is black. `reflectance`
/// has 3 channels.
std::vector<int> true_slots(const Image& reflectance, std::span<const BaseColors::Color> colors);

struct TruthClick {
  int x = 0, y = 0;
  int slot = -1;           ///< true base color of most of the region
  std::size_t pixels = 0;  ///< of the region
};

/// Clicks on misclustered regions: connected pixels (by edges) of one slot of which more than half
/// truly have another, `least` pixels or more; the largest first, `most` at most. Each lies on a
/// pixel of its region that is misclustered and nearest to their middle. `slots` and `truth`: row
/// by row, −1 where nothing is known, which counts as right.
std::vector<TruthClick> clicks_of_truth(const std::vector<int>& slots,
                                        const std::vector<int>& truth, int width, int height,
                                        std::size_t least, std::size_t most);

/// Chromaticity (mean 1) of a color.
std::array<double, 3> chromaticity(double r, double g, double b);

/// For each base color with a layer, in their order, the distance in chromaticity (mean 1) from the
/// mean chromaticity of true reflectance of the pixels that were assigned to it; NaN where these
/// are fewer than `least`. `initial`: of the colors before refinement.
std::vector<double> base_color_errors(const Image& reflectance, const std::vector<int>& slots,
                                      std::span<const BaseColors::Color> colors, bool initial,
                                      std::size_t least);

}  // namespace inverse::bench
