// SPDX-License-Identifier: LGPL-2.1-or-later
// A network that changes the fitted prior of intrinsicdecomp: what it sees of a guide, and what its
// output says. Double precision; docs/reference/methods/intrinsicdecomp.md, 2.
#pragma once

#include <array>
#include <vector>

#include "intrinsic_features.hpp"
#include "tests/reference/network/network.hpp"

namespace inverse::reference {

inline constexpr int kMaxPriorSide = 256;  ///< Of the network's picture.
inline constexpr int kPriorStep = 16;      ///< Its input is padded to multiples of this.
inline constexpr int kPriorFields = 3;     ///< The output has four channels for each.
inline constexpr double kPriorInput = 8;   ///< Largest size of an input.

/// ln v, V, ln g.
using PriorFields = std::array<double, kPriorFields>;
inline constexpr double kPriorLimit = 5;  ///< What the fields saturate to.

/// The network's picture of a frame.
struct PriorPicture {
  int level = 0;  ///< One of its pixels is 2^level x 2^level pixels of the frame.
  int width = 0, height = 0;
  /// Of the least level, or of a higher one if that would be larger than kMaxPriorSide.
  PriorPicture(int frame_width, int frame_height, int least_level = 0);
};

/// The input, 6 channels: the picture of the guide's frame.
Image prior_input(const Guide& guide);
Image prior_input(const Guide& guide, const PriorPicture& picture);

/// Fields of every pixel of the picture, row by row, from the output. NaN counts as 0.
std::vector<PriorFields> prior_fields(const Image& output, const PriorPicture& picture);

/// For a network that estimates reflectance. Its input, 3 channels: the picture in white light,
/// sRGB in [0, 1].
Image image_input(const Guide& guide, const PriorPicture& picture);

inline constexpr double kPaintTrust = 1.5;                            ///< Change of ln v and ln g.
inline constexpr double kPaintReach = 6;                              ///< Of V.
inline constexpr double kDarkestPaint = 1e-3, kBrightestPaint = 1e3;  ///< R is clamped to these.

/// The fields from its output, linear reflectance. A pixel with a NaN has fields of 0.
std::vector<PriorFields> reflectance_fields(const Image& reflectance, const Guide& guide,
                                            const PriorPicture& picture);

/// What a network says of a frame.
class PriorNetwork {
 public:
  /// The graph takes the channels of prior_input or those of image_input.
  PriorNetwork(const Guide& guide, const network::Graph& graph);
  PriorNetwork(PriorPicture picture, std::vector<PriorFields> fields)
      : picture_(picture), fields_(std::move(fields)) {}
  /// Of a cell of guide level kCellLevel: of the pixel that holds it, or the mean of those in it.
  PriorFields at_cell(int x, int y) const;

 private:
  const PriorFields& at(int x, int y) const {
    return fields_[std::size_t(y) * std::size_t(picture_.width) + std::size_t(x)];
  }
  PriorPicture picture_;
  std::vector<PriorFields> fields_;
};

}  // namespace inverse::reference
