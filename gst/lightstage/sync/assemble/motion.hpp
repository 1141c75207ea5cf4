// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <opencv2/core.hpp>

namespace inverse {

/// Motion of a subject from one picture to another: dense optical flow (DIS, Kroeger et al. 2016),
/// a displacement in pixels (CV_32FC2) for each pixel of the first picture.
class Motion {
 public:
  /// Input of the flow: light (CV_32FC3, linear, 1 = full scale) as 8-bit gray over the whole
  /// range, dark parts included.
  static cv::Mat gray(const cv::Mat& light);
  /// The displacement of each pixel of `from` to its place in `to`, both from `gray`. Starts from
  /// `guess` if it is not empty.
  static cv::Mat between(const cv::Mat& from, const cv::Mat& to, const cv::Mat& guess = {});
  /// Half of the motion from picture `later` to `earlier`, on the grid halfway in time: the
  /// displacement of a pixel there to its place in `later`.
  static cv::Mat half(const cv::Mat& later, const cv::Mat& earlier);
  /// The picture whose pixel p is that of `image` at p + displacement, clamped to its borders.
  static cv::Mat moved(const cv::Mat& image, const cv::Mat& displacement);
};

}  // namespace inverse
