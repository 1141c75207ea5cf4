// What the truth says about base colors (thesis, chapter 5): which pixels were taken for a wrong
// one, where somebody who sees that would click, and how far base colors are from the paint.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/thesis/chapter5/colors/base_colors.hpp"
#include "tests/bench/metrics/image.hpp"

namespace inverse::bench {

/// The base colors that the pixels of a frame truly have: nearest to their reflectance in ln
/// chromaticity, as pixels of a frame are assigned.
class TrueSlots {
 public:
  /// `reflectance` has 3 channels; nothing is known where it is black, and where `mask` (if not
  /// empty) is 0.
  TrueSlots(const Image& reflectance, const Image& mask, std::span<const BaseColors::Color> colors);

  /// Slot by pixel, row by row; −1 where nothing is known.
  const std::vector<int>& nearest() const { return nearest_; }
  /// For each pixel whether its slot here is clearly further away than the true one: by kMargin. No
  /// slot (−1) is never wrong.
  std::vector<std::uint8_t> wrong(const std::vector<int>& slots) const;

 private:
  static constexpr float kMargin = 0.1F;  // in ln chromaticity
  std::vector<int> nearest_;
  std::vector<std::array<float, BaseColors::kMaxColors>> distances_;  // to each slot
};

/// Pixels of one slot that hang together, by edges.
struct Component {
  int cluster = -1;         ///< their slot
  std::vector<int> pixels;  ///< row by row, in the order of a fill
  std::size_t wrong = 0;    ///< of them
  int right = -1;           ///< slot that most of those should have
  bool mostly_wrong() const { return 2 * wrong > pixels.size(); }
  /// The pixel that somebody clicks on.
  int click() const { return pixels[pixels.size() / 2]; }
};

/// `wrong` tells of each pixel whether it is, `truth` which slot it should have.
std::vector<Component> components(const std::vector<int>& slots,
                                  const std::vector<std::uint8_t>& wrong,
                                  const std::vector<int>& truth, int width, int height);

/// A region is wrong that has a cluster, is no smaller than this share of the frame, and of which
/// more than half of the pixels are.
inline constexpr double kLeastShare = 0.005;
/// Those among the components, the largest first.
std::vector<Component> wrong_components(const std::vector<int>& slots,
                                        const std::vector<std::uint8_t>& wrong,
                                        const std::vector<int>& truth, int width, int height,
                                        double least = kLeastShare);

/// Chromaticity (mean 1) of a color.
std::array<double, 3> chromaticity(double r, double g, double b);

/// For each base color with a layer, in their order, the distance in chromaticity (mean 1) from the
/// mean chromaticity of true reflectance of the pixels that were assigned to it; NaN where these
/// are fewer than `least`. `initial`: of the colors before refinement.
std::vector<double> base_color_errors(const Image& reflectance, const std::vector<int>& slots,
                                      std::span<const BaseColors::Color> colors, bool initial,
                                      std::size_t least);

}  // namespace inverse::bench
