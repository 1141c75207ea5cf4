// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <map>
#include <opencv2/core.hpp>

namespace inverse {

/// Motion of a subject over a capture, from fully lit tracking frames: displacements from the last
/// of them, linearly interpolated in time (thesis 7.3.2).
class OlatMotion {
 public:
  /// `tracking`: the tracking frames by trigger, from Motion::gray; at least one.
  explicit OlatMotion(const std::map<uint64_t, cv::Mat>& tracking);
  /// The displacement of each pixel of the last tracking frame at this trigger; constant before the
  /// first tracking frame and after the last.
  cv::Mat at(uint64_t trigger) const;
  /// Mean length of all displacements, in pixels.
  double mean_length() const;

 private:
  std::map<uint64_t, cv::Mat> displacements_;
};

}  // namespace inverse
