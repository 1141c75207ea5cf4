// SPDX-License-Identifier: LGPL-2.1-or-later
#include "olat_motion.hpp"

#include "motion.hpp"

namespace inverse {

OlatMotion::OlatMotion(const std::map<uint64_t, cv::Mat>& tracking) {
  const auto& [last, reference] = *tracking.rbegin();
  displacements_[last] = cv::Mat::zeros(reference.size(), CV_32FC2);
  // Backwards in time: each starts from the flow of the one after it.
  cv::Mat guess;
  for (auto frame = std::next(tracking.rbegin()); frame != tracking.rend(); ++frame) {
    guess = Motion::between(reference, frame->second, guess);
    displacements_[frame->first] = guess;
  }
}

cv::Mat OlatMotion::at(uint64_t trigger) const {
  const auto after = displacements_.lower_bound(trigger);
  if (after == displacements_.end()) return displacements_.rbegin()->second;
  if (after == displacements_.begin() || after->first == trigger) return after->second;
  const auto before = std::prev(after);
  const double share = static_cast<double>(trigger - before->first) /
                       static_cast<double>(after->first - before->first);
  return before->second * (1 - share) + after->second * share;
}

double OlatMotion::mean_length() const {
  double sum = 0, count = 0;
  for (const auto& [trigger, displacement] : displacements_)
    for (int y = 0; y < displacement.rows; y += 4)
      for (int x = 0; x < displacement.cols; x += 4) {
        sum += cv::norm(displacement.at<cv::Vec2f>(y, x));
        ++count;
      }
  return count > 0 ? sum / count : 0;
}

}  // namespace inverse
