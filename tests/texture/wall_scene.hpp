// SPDX-License-Identifier: LGPL-2.1-or-later
// A wall with a poster before a camera that moves by hand, under a light with a soft shadow;
// something passes in front of it, and the camera looks away and back. Every frame comes with the
// truth.
#pragma once
#include <opencv2/core.hpp>
#include <string>

#include "kernels/texture/quad.hpp"

namespace inverse::testing {

class WallScene {
 public:
  struct Frame {
    cv::Mat picture;   ///< CV_8UC3, R G B
    cv::Mat occluder;  ///< CV_32F, 0…1: what stands before the wall
    Corners corners;   ///< of the poster; anywhere
  };
  /// `poster` is CV_8UC3, R G B, or empty: blobs of all sizes are drawn.
  WallScene(cv::Size frame, const cv::Mat& poster = {}, double noise = 2);

  /// A frame of a video of kFrames.
  Frame at(int number) const;
  Corners corners_at(int number) const;
  /// The picture of the poster, R G B.
  const cv::Mat& poster() const { return poster_; }

  static constexpr int kFrames = 300;
  static constexpr int kOccludedFrom = 60, kOccludedTo = 130;
  static constexpr int kAwayFrom = 170,
                       kAwayTo = 215;  ///< the poster is out of the picture in between

 private:
  cv::Matx33d camera(int number) const;

  cv::Size size_;
  cv::Mat poster_, wall_;  // wall_: CV_32FC3, linear reflectance
  double noise_;
};

/// Writes a CV_8UC3, R G B, as PNG; returns the path.
std::string write_picture(const std::string& path, const cv::Mat& picture);

/// The largest distance of a corner from the true one, pixels.
double corner_error(const Corners& found, const Corners& truth);

}  // namespace inverse::testing
