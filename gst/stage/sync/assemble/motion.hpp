// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <opencv2/core.hpp>

namespace inverse {

/// Where a subject has moved from one picture to another: dense optical flow (DIS, Kroeger et al.
/// 2016), a displacement in pixels (CV_32FC2) for each pixel of the first picture.
class Motion {
 public:
  /// What flow is measured in: light (CV_32FC3, linear, 1 = full scale) as 8 bits of gray that use
  /// the whole range, dark parts included.
  static cv::Mat gray(const cv::Mat& light);
  /// The displacement of each pixel of `from` to where it is in `to`, both as `gray` makes them.
  /// `guess` may hold one to start from.
  static cv::Mat between(const cv::Mat& from, const cv::Mat& to, const cv::Mat& guess = {});
  /// Half of the motion from picture `later` to `earlier`, on the grid of the moment halfway: how
  /// far a pixel there is from where it is in `later`.
  static cv::Mat half(const cv::Mat& later, const cv::Mat& earlier);
  /// The picture whose pixel p is that of `image` at p + displacement; beyond its borders what is
  /// nearest.
  static cv::Mat moved(const cv::Mat& image, const cv::Mat& displacement);
};

}  // namespace inverse
