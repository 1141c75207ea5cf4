// SPDX-License-Identifier: LGPL-2.1-or-later
// The scale of reflectance over a video, in double precision. This is the specification of
// kernels/solve/scale_normalization (scale.glsl, scale_track.comp, scale_update.comp).
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "tests/reference/image/light_color.hpp"

namespace inverse::reference {

/// Of a cell: mean log intensity, two log ratios of its color, mean log reflectance.
using ScaleCell = std::array<double, 4>;

class ScaleNormalization {
 public:
  /// Cells a row and rows.
  ScaleNormalization(int width, int height);

  /// Of a single frame: ln c minus ln(white level); `dark` if no cell of it counts; log shading of
  /// its brightest light.
  struct ScaleTarget {
    double offset = 0;
    bool dark = false;
    double brightest = 0;
  };
  /// ln c of a frame. `carries`: it continues the one before. `light`: by which the color of the
  /// cells was corrected.
  double update(const std::vector<ScaleCell>& cells, const ScaleTarget& target, bool carries,
                double white_level, const LightColor& light = {});
  /// Log shading, in the output, of the brightest light of the scene's first frame; it follows the
  /// exposure, and rises if the scene lights up.
  double white() const { return white_ - log_white_; }
  /// Common change of m since the first frame that does not go with a change of light's color.
  double exposure() const { return exposure_; }
  /// Share of the points that were found again.
  double found() const { return found_; }

 private:
  /// Of a point in a past frame: log reflectance in the output; m; ln R/B as it is seen; exposure.
  using Past = std::array<double, 4>;
  struct Point {
    double x = 0, y = 0;
    std::deque<Past> history;  // the oldest first; empty: lost
  };
  struct Sample {
    double offset, weight, exposure, exposure_weight, texture, from[2], motion[2];
    bool bright, found;
  };
  struct Motion {
    double x = 0, y = 0, zoom = 0, turn = 0;
    /// Of a place `from` the frame's center.
    std::array<double, 2> at(double from_x, double from_y) const {
      return {x + zoom * from_x - turn * from_y, y + zoom * from_y + turn * from_x};
    }
  };
  /// Log intensity and chroma by binomial weights over 5 x 5 cells.
  std::vector<ScaleCell> smoothed(const std::vector<ScaleCell>& cells) const;
  ScaleCell between(const std::vector<ScaleCell>& cells, double x, double y) const;
  std::array<double, 2> sparse_place(uint32_t index, const std::vector<Point>& others) const;
  Sample track(Point& point, uint32_t index, const std::vector<Point>& others,
               const std::vector<ScaleCell>& cells, const LightColor& light) const;
  /// Takes one step of least squares from `motion`, with robust weights.
  static void fit(Motion& motion, const std::vector<Sample>& samples, double weight_of_none);

  int width_, height_, columns_, rows_;
  double spacing_;
  std::vector<ScaleCell> before_;
  std::vector<Point> points_;
  bool known_ = false, has_history_ = false;
  Motion motion_;
  uint32_t frames_ = 0;  // that points were followed through
  double offset_ = 0, target_ = 0, bright_ = 0, found_ = 0;
  double white_ = 0, log_white_ = 0, exposure_ = 0;
  LightColor light_;  // of the frame before
};

}  // namespace inverse::reference
