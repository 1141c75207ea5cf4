// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <vector>

namespace inverse {
namespace {

constexpr int kMinSize = 64;      // DIS needs some levels and whole patches
constexpr double kWhite = 0.995;  // share of pixels below white
constexpr int kFixedPointSteps = 4;

cv::Mat enlarged(const cv::Mat& image) {
  const int right = std::max(0, kMinSize - image.cols), below = std::max(0, kMinSize - image.rows);
  if (!right && !below) return image;
  cv::Mat large;
  cv::copyMakeBorder(image, large, 0, below, 0, right, cv::BORDER_REPLICATE);
  return large;
}

cv::Mat grid_plus(const cv::Mat& displacement) {
  cv::Mat map(displacement.size(), CV_32FC2);
  for (int y = 0; y < map.rows; ++y) {
    const auto* d = displacement.ptr<cv::Vec2f>(y);
    auto* to = map.ptr<cv::Vec2f>(y);
    for (int x = 0; x < map.cols; ++x)
      to[x] = {static_cast<float>(x) + d[x][0], static_cast<float>(y) + d[x][1]};
  }
  return map;
}

}  // namespace

cv::Mat Motion::gray(const cv::Mat& light) {
  cv::Mat luminance;
  cv::transform(light, luminance, cv::Matx13f(1.0F / 3, 1.0F / 3, 1.0F / 3));
  cv::patchNaNs(luminance, 0);
  std::vector<float> values;
  for (int y = 0; y < luminance.rows; y += 2)
    for (int x = 0; x < luminance.cols; x += 2) values.push_back(luminance.at<float>(y, x));
  const auto at = values.begin() + static_cast<ptrdiff_t>(kWhite * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  const float white = std::max(*at, 1e-5F);
  cv::Mat scaled, gray;
  cv::sqrt(cv::max(luminance, 0) / white, scaled);
  scaled.convertTo(gray, CV_8U, 255);
  return gray;
}

cv::Mat Motion::between(const cv::Mat& from, const cv::Mat& to, const cv::Mat& guess) {
  const auto flow = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM);
  flow->setFinestScale(1);
  cv::Mat displacement;
  if (!guess.empty()) displacement = enlarged(guess).clone();
  flow->calc(enlarged(from), enlarged(to), displacement);
  return displacement(cv::Rect(0, 0, from.cols, from.rows)).clone();
}

cv::Mat Motion::half(const cv::Mat& later, const cv::Mat& earlier) {
  const cv::Mat back = between(later, earlier);
  // p = q + back(q) / 2 is the place of pixel q of `later` halfway; q from p, by fixed point.
  cv::Mat displacement = back * -0.5;
  for (int step = 0; step < kFixedPointSteps; ++step)
    displacement = moved(back, displacement) * -0.5;
  return displacement;
}

cv::Mat Motion::moved(const cv::Mat& image, const cv::Mat& displacement) {
  cv::Mat result;
  const int how = image.type() == CV_32FC2 ? cv::INTER_LINEAR : cv::INTER_CUBIC;
  cv::remap(image, result, grid_plus(displacement), {}, how, cv::BORDER_REPLICATE);
  return result;
}

}  // namespace inverse
