// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <map>
#include <opencv2/core.hpp>

namespace inverse {

/// Where a subject was at any time of a capture, from frames under full light in which it can be
/// tracked: displacements from the last of them, linearly interpolated in time (thesis 7.3.2).
class OlatMotion {
 public:
  /// `tracking`: what Motion::gray makes of the tracking frames, by trigger; at least one.
  explicit OlatMotion(const std::map<uint64_t, cv::Mat>& tracking);
  /// Of each pixel of the last tracking frame to where it is at this trigger; before the first
  /// tracking frame and after the last as in these.
  cv::Mat at(uint64_t trigger) const;
  /// Mean length of all displacements, in pixels.
  double mean_length() const;

 private:
  std::map<uint64_t, cv::Mat> displacements_;
};

}  // namespace inverse
