// SPDX-License-Identifier: LGPL-2.1-or-later
// Truth about base colors (thesis, chapter 5): misclustered pixels, clicks of a user who sees them,
// and the distance of base colors from the paint.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/thesis/chapter5/colors/base_colors.hpp"
#include "tests/bench/metrics/image.hpp"

namespace inverse::bench {

/// The true base color of each pixel: the nearest to its reflectance in ln chromaticity, with the
/// assignment rule of the method.
class TrueSlots {
 public:
  /// `reflectance` has 3 channels; pixels are unknown if it is black or `mask` (if not empty) is 0.
  TrueSlots(const Image& reflectance, const Image& mask, std::span<const BaseColors::Color> colors);

  /// Slot by pixel, row by row; −1 for unknown pixels.
  const std::vector<int>& nearest() const { return nearest_; }
  /// Whether each pixel's slot is farther than the true one by more than kMargin. No slot (−1)
  /// counts as right.
  std::vector<std::uint8_t> wrong(const std::vector<int>& slots) const;

 private:
  static constexpr float kMargin = 0.1F;  // in ln chromaticity
  std::vector<int> nearest_;
  std::vector<std::array<float, BaseColors::kMaxColors>> distances_;  // to each slot
};

/// A 4-connected component of pixels of one slot.
struct Component {
  int cluster = -1;         ///< their slot
  std::vector<int> pixels;  ///< row by row, in the order of a fill
  std::size_t wrong = 0;    ///< number of wrong pixels
  int right = -1;           ///< slot that most of the wrong pixels should have
  bool mostly_wrong() const { return 2 * wrong > pixels.size(); }
  /// The position of a click.
  int click() const { return pixels[pixels.size() / 2]; }
};

/// `wrong`: per pixel, whether it is wrong; `truth`: the slot it should have.
std::vector<Component> components(const std::vector<int>& slots,
                                  const std::vector<std::uint8_t>& wrong,
                                  const std::vector<int>& truth, int width, int height);

/// A region is wrong if it has a cluster, is at least this share of the frame, and more than half
/// of its pixels are wrong.
inline constexpr double kMinShare = 0.005;
/// The wrong components, largest first.
std::vector<Component> wrong_components(const std::vector<int>& slots,
                                        const std::vector<std::uint8_t>& wrong,
                                        const std::vector<int>& truth, int width, int height,
                                        double min_share = kMinShare);

/// Chromaticity (mean 1) of a color.
std::array<double, 3> chromaticity(double r, double g, double b);

/// For each base color with a layer, in order, the chromaticity distance (mean 1) to the mean true
/// chromaticity of its assigned pixels; NaN if these are fewer than `min_pixels`. `initial`: of the
/// colors before refinement.
std::vector<double> base_color_errors(const Image& reflectance, const std::vector<int>& slots,
                                      std::span<const BaseColors::Color> colors, bool initial,
                                      std::size_t min_pixels);

}  // namespace inverse::bench
