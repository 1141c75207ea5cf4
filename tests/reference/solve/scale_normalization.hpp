// SPDX-License-Identifier: LGPL-2.1-or-later
// The scale of reflectance over a video, in double precision. This is the specification of
// kernels/solve/scale_normalization (scale.glsl, scale_track.comp, scale_update.comp).
#pragma once

#include <array>
#include <vector>

namespace inverse::reference {

/// Of a cell: mean log intensity, two log ratios of its color, mean log reflectance.
using ScaleCell = std::array<double, 4>;

class ScaleNormalization {
 public:
  /// Cells a row and rows.
  ScaleNormalization(int width, int height);

  /// Target of a single frame: ln c minus ln(white level); `dark` if no cell of it counts.
  struct Wanted {
    double offset = 0;
    bool dark = false;
  };
  /// ln c of a frame. `carries`: it continues the one before. `frozen`: the scale stays.
  double update(const std::vector<ScaleCell>& cells, const Wanted& wanted, bool carries,
                double white_level, bool frozen = false);
  /// Shares of the points that were tracked, and of those that are bright.
  double found() const { return found_; }

 private:
  struct Point {
    double x = 0, y = 0, reflectance = 0, frames = -1, color[2] = {};
  };
  struct Sample {
    double offset, weight, texture, motion[2];
    bool bright, found;
  };
  ScaleCell between(const std::vector<ScaleCell>& cells, double x, double y) const;
  Sample track(Point& point, int index, const std::vector<ScaleCell>& cells) const;

  int width_, height_, columns_, rows_;
  double spacing_;
  std::vector<ScaleCell> before_;
  std::vector<Point> points_;
  bool known_ = false, goes_on_ = false;
  double offset_ = 0, wanted_ = 0, motion_[2] = {}, bright_ = 0, shift_ = 0, found_ = 0;
};

}  // namespace inverse::reference
