// SPDX-License-Identifier: LGPL-2.1-or-later
#include "wall_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace inverse::testing {
namespace {

// Meters: the wall is around the origin, y down; the poster is in its middle.
constexpr double kWallWidth = 6, kWallHeight = 4, kPosterHeight = 1;
constexpr double kTexels = 400;  // a meter
constexpr int kSamples = 2;      // a pixel's side

double ease(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// 8-bit sRGB to linear light.
cv::Mat linear(const cv::Mat& codes) {
  cv::Mat out;
  codes.convertTo(out, CV_32F, 1 / 255.0);
  cv::pow(out, 2.2, out);
  return out;
}

/// Blobs of all sizes and colors.
cv::Mat blobs(cv::Size size, uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat out(size, CV_8UC3, cv::Scalar(150, 140, 120));
  const double side = std::min(size.width, size.height);
  for (int i = 0; i < 400; ++i) {
    const double radius = side * 0.2 * std::pow(0.04, i / 400.0);
    const cv::Scalar color(random.uniform(20, 235), random.uniform(20, 235),
                           random.uniform(20, 235));
    cv::ellipse(
        out, {random.uniform(0, size.width), random.uniform(0, size.height)},
        {std::max(1, cvRound(radius)), std::max(1, cvRound(radius * random.uniform(.3, 1.)))},
        random.uniform(0., 180.), 0, 360, color, cv::FILLED, cv::LINE_AA);
  }
  return out;
}

double poster_width(const cv::Mat& poster) { return kPosterHeight * poster.cols / poster.rows; }

cv::Point2d on_wall(double x, double y) {
  return {(x + kWallWidth / 2) * kTexels, (y + kWallHeight / 2) * kTexels};
}

}  // namespace

std::string write_picture(const std::string& path, const cv::Mat& picture) {
  if (!stbi_write_png(path.c_str(), picture.cols, picture.rows, 3, picture.data,
                      static_cast<int>(picture.step)))
    throw std::runtime_error("cannot write " + path);
  return path;
}

double corner_error(const Corners& found, const Corners& truth) {
  double largest = 0;
  for (size_t i = 0; i < 4; ++i)
    largest = std::max(largest, std::hypot(found[i][0] - truth[i][0], found[i][1] - truth[i][1]));
  return largest;
}

WallScene::WallScene(cv::Size frame, const cv::Mat& poster, double noise)
    : size_(frame), poster_(poster.empty() ? blobs({640, 480}, 7) : poster), noise_(noise) {
  // Plaster with little of its own, and a few things on it.
  cv::Mat wall(cvRound(kWallHeight * kTexels), cvRound(kWallWidth * kTexels), CV_8UC3,
               cv::Scalar(190, 185, 175));
  cv::RNG random(3);
  cv::Mat grain(wall.size() / 8, CV_8UC3);
  random.fill(grain, cv::RNG::NORMAL, cv::Scalar::all(128), cv::Scalar::all(5));
  cv::resize(grain, grain, wall.size(), 0, 0, cv::INTER_CUBIC);
  cv::addWeighted(wall, 1, grain, 1, -128, wall);
  for (int i = 0; i < 8; ++i) {
    const cv::Mat thing = blobs({160, 120}, 20 + static_cast<uint64_t>(i));
    const cv::Point place((i % 4) * wall.cols / 4 + 120, i < 4 ? 150 : wall.rows - 300);
    thing.copyTo(wall(cv::Rect(place, thing.size())));
  }
  wall_ = linear(wall);
  const double w = poster_width(poster_);
  const cv::Rect place(on_wall(-w / 2, -kPosterHeight / 2),
                       cv::Size(cvRound(w * kTexels), cvRound(kPosterHeight * kTexels)));
  cv::Mat scaled;
  cv::resize(linear(poster_), scaled, place.size(), 0, 0, cv::INTER_AREA);
  scaled.copyTo(wall_(place));
}

/// From meters on the wall to pixels.
cv::Matx33d WallScene::camera(int number) const {
  constexpr double kTurn = 2 * std::numbers::pi;
  const double t = number / double{kFrames};
  const double away = ease((number - kAwayFrom + 15) / 20.0) - ease((number - kAwayTo) / 20.0);
  // Shaken by hand, coming nearer and going away, around the poster.
  const double yaw =
      0.35 * std::sin(kTurn * 1.3 * t) + 0.004 * std::sin(kTurn * 23 * t) + 1.1 * away;
  const double pitch = 0.12 * std::sin(kTurn * 1.7 * t + 1) + 0.004 * std::sin(kTurn * 31 * t);
  const double roll = 0.12 * std::sin(kTurn * t + 2);
  const double side = 0.9 * std::sin(kTurn * 1.3 * t), up = 0.2 * std::sin(kTurn * 1.7 * t + 1);
  const double distance = 2.1 + 0.7 * std::cos(kTurn * 1.1 * t);
  const auto about = [](double angle, int axis) {
    const double c = std::cos(angle), s = std::sin(angle);
    return axis == 0   ? cv::Matx33d(1, 0, 0, 0, c, -s, 0, s, c)
           : axis == 1 ? cv::Matx33d(c, 0, s, 0, 1, 0, -s, 0, c)
                       : cv::Matx33d(c, -s, 0, s, c, 0, 0, 0, 1);
  };
  const cv::Matx33d turned = about(roll, 2) * about(pitch, 0) * about(yaw, 1);
  const cv::Vec3d place(side, up, -distance);
  const double focal = 0.95 * size_.width;
  const cv::Matx33d lens(focal, 0, size_.width / 2.0, 0, focal, size_.height / 2.0, 0, 0, 1);
  const cv::Vec3d moved = turned * place;
  cv::Matx33d plane = turned;  // of the wall, z = 0
  for (int k = 0; k < 3; ++k) plane(k, 2) = -moved[k];
  return lens * plane;
}

Corners WallScene::corners_at(int number) const {
  const cv::Matx33d h = camera(number);
  const double w = poster_width(poster_) / 2, v = kPosterHeight / 2;
  const cv::Point2d ends[4] = {{-w, -v}, {w, -v}, {w, v}, {-w, v}};
  Corners corners;
  for (size_t i = 0; i < 4; ++i) {
    const cv::Vec3d p = h * cv::Vec3d(ends[i].x, ends[i].y, 1);
    corners[i] = {p[0] / p[2], p[1] / p[2]};
  }
  return corners;
}

WallScene::Frame WallScene::at(int number) const {
  Frame frame;
  frame.corners = corners_at(number);
  const cv::Matx33d h = camera(number);
  // In pixels of the wall's picture and of the finer frame, whose centers have whole coordinates.
  const cv::Matx33d fine(kSamples, 0, -0.5, 0, kSamples, -0.5, 0, 0, 1);
  const cv::Matx33d meters(1 / kTexels, 0, (0.5 / kTexels) - kWallWidth / 2, 0, 1 / kTexels,
                           (0.5 / kTexels) - kWallHeight / 2, 0, 0, 1);
  cv::Mat seen;
  cv::warpPerspective(wall_, seen, cv::Mat(fine * h * meters), size_ * kSamples, cv::INTER_LINEAR,
                      cv::BORDER_CONSTANT, cv::Scalar(0.05, 0.06, 0.05));
  cv::Mat light(size_ * kSamples, CV_32F);
  const cv::Matx33d back = (fine * h).inv();
  const double shadow = -1.5 + 3.0 * number / kFrames;
  // In this thread: OpenCV's own are not built with a sanitizer, which would see races.
  for (int row = 0; row < light.rows; ++row)
    for (int column = 0; column < light.cols; ++column) {
      const cv::Vec3d p = back * cv::Vec3d(column, row, 1);
      const double x = p[0] / p[2], y = p[1] / p[2];
      const double lamp = 1.1 / (1 + 0.12 * ((x + 1) * (x + 1) + (y + 1) * (y + 1)));
      const double edge = (x - shadow + 0.3 * y) / 0.25;
      light.at<float>(row, column) = static_cast<float>(lamp * (1 - 0.55 / (1 + std::exp(-edge))));
    }
  cv::Mat lights;
  cv::merge(std::vector<cv::Mat>(3, light), lights);
  seen = seen.mul(lights);
  cv::Mat mask(size_ * kSamples, CV_8U, cv::Scalar(0));
  if (number >= kOccludedFrom && number < kOccludedTo) {
    // A dark sleeve with a hand goes across.
    const double along = (number - kOccludedFrom) / double{kOccludedTo - kOccludedFrom};
    const cv::Point2d hand(mask.cols * (1.15 - 1.4 * along), mask.rows * 0.5);
    const double side = mask.cols * 0.09;
    cv::ellipse(mask, hand, {cvRound(side), cvRound(0.7 * side)}, 20, 0, 360, 255, cv::FILLED);
    cv::line(mask, hand, {cvRound(hand.x + 0.3 * side), 2 * mask.rows}, 255, cvRound(1.1 * side));
    cv::Mat skin(mask.size(), CV_32FC3, cv::Scalar(0.06, 0.05, 0.11));
    cv::ellipse(skin, hand, {cvRound(side), cvRound(0.7 * side)}, 20, 0, 360,
                cv::Scalar(0.45, 0.22, 0.14), cv::FILLED);
    for (int i = 0; i < 40; ++i)  // folds of the sleeve
      cv::line(skin, hand + cv::Point2d(-side, side + i * side / 8),
               hand + cv::Point2d(side, side * 1.2 + i * side / 8), cv::Scalar(0.03, 0.03, 0.06),
               2);
    skin.copyTo(seen, mask);
  }
  cv::Mat small, cover;
  cv::resize(seen, small, size_, 0, 0, cv::INTER_AREA);
  mask.convertTo(cover, CV_32F, 1 / 255.0);
  cv::resize(cover, frame.occluder, size_, 0, 0, cv::INTER_AREA);
  cv::pow(cv::min(small, 1.0), 1 / 2.2, small);
  cv::Mat noise(size_, CV_32FC3);
  cv::RNG random(static_cast<uint64_t>(number) + 100);
  random.fill(noise, cv::RNG::NORMAL, cv::Scalar::all(0), cv::Scalar::all(noise_));
  cv::Mat codes = small * 255 + noise;
  codes.convertTo(frame.picture, CV_8U);
  return frame;
}

}  // namespace inverse::testing
