// SPDX-License-Identifier: LGPL-2.1-or-later
// Estimate of the indirect light from the image itself: every visible surface is an emitter of its
// own radiance, and the light at a point is a wide blur of the image plus its mean.
#pragma once

#include "global_color.hpp"

namespace inverse::reference::global {

struct GatherParams {
  double reach = 0.4;       ///< Standard deviation of the blur, of the grid's width; > 0.
  double near_share = 0.7;  ///< Share of the blur beside that of the frame's mean, 0 ... 1.
  double own = 0.8;         ///< Share of a surface's own label that does not light it, 0 ... 1.
};

/// For every label k, on a grid of half the points: the blurred light and number of the surfaces of
/// that label; and from them the indirect light that a surface of label j receives, up to the
/// scene's amount.
class Gather {
 public:
  Gather() = default;
  /// `labels` (0 ... count - 1) of the grid's points.
  Gather(const Grid& grid, const std::vector<int>& labels, int count, const GatherParams& params);

  /// E0 at the center of a fine point (factor fine points to a point of this grid).
  Vec3 received(int label, int x, int y, int factor) const;
  /// The part of it that comes from surfaces of label k.
  Vec3 received_from(int k, int label, int x, int y, int factor) const;

 private:
  template <class Value>
  Vec3 blend(const Value& value, int x, int y, int factor) const;
  double emitters(int label, std::size_t j) const;  // around a point that label j is not to see
  std::size_t size() const { return std::size_t(width_) * std::size_t(height_); }

  GatherParams params_;
  double own_ = 0;
  int width_ = 0, height_ = 0;
  std::vector<std::vector<Vec4>> emitted_;   // per label: blurred I and count
  std::vector<double> number_;               // blurred count of all
  std::vector<Vec3> mean_;                   // per label: its part of the frame's mean
  std::vector<std::vector<Vec3>> received_;  // per label: E0
};

}  // namespace inverse::reference::global
