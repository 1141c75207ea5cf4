// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plane_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <utility>

namespace inverse {
namespace {

constexpr int kMaxFeatures = 300, kMaxKeypoints = 800, kMaxPictureKeypoints = 1500;
constexpr unsigned kMinInliers = 8;
constexpr double kMinInlierShare = 0.2;  // of the features in the picture
constexpr int kNormalization = 31;       // pixels
constexpr float kNoise = 0.02F;          // deviation of luminance that is not amplified
constexpr double kGross = 3, kFine = 1;  // distance of an inlier from the homography, pixels
constexpr int kRefinements = 2;
constexpr float kMaxRefinement = 5;      // pixels by which a point may be off before it
constexpr unsigned kSearchInterval = 3;  // pictures
constexpr float kMatchRatio = 0.8F;
constexpr double kMaxScale = 20;
const cv::TermCriteria kStop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.003);

cv::Point2f opencv_point(const Point& p) {
  return {static_cast<float>(p[0] - 0.5), static_cast<float>(p[1] - 0.5)};
}

cv::Point2f mapped(const cv::Matx33d& h, const cv::Point2f& p) {
  const cv::Vec3d q = h * cv::Vec3d(p.x, p.y, 1);
  return {static_cast<float>(q[0] / q[2]), static_cast<float>(q[1] / q[2])};
}

Corners mapped(const cv::Matx33d& h, const Corners& corners) {
  Corners out;
  for (size_t i = 0; i < 4; ++i) {
    const cv::Vec3d q = h * cv::Vec3d(corners[i][0] - 0.5, corners[i][1] - 0.5, 1);
    out[i] = {q[0] / q[2] + 0.5, q[1] / q[2] + 0.5};
  }
  return out;
}

/// Luminance less its local mean, over its local deviation, in 8 bits.
cv::Mat normalized(const cv::Mat& luminance) {
  cv::Mat mean, square, out;
  const cv::Size window(kNormalization, kNormalization);
  cv::boxFilter(luminance, mean, CV_32F, window, {-1, -1}, true, cv::BORDER_REFLECT);
  cv::sqrBoxFilter(luminance, square, CV_32F, window, {-1, -1}, true, cv::BORDER_REFLECT);
  cv::Mat variance = square - mean.mul(mean);
  variance = cv::max(variance, 0) + kNoise * kNoise;
  cv::Mat deviation;
  cv::sqrt(variance, deviation);
  cv::Mat scaled = (luminance - mean) / deviation;
  scaled.convertTo(out, CV_8U, 40, 128);
  return out;
}

cv::Mat eight_bits(const cv::Mat& luminance) {
  cv::Mat out;
  luminance.convertTo(out, CV_8U, 255);
  return out;
}

/// A quadrilateral widened about its middle.
std::vector<cv::Point> widened(const Corners& corners, double factor) {
  Point middle{};
  for (const Point& p : corners)
    for (size_t k = 0; k < 2; ++k) middle[k] += p[k] / 4;
  std::vector<cv::Point> out;
  for (const Point& p : corners)
    out.emplace_back(cvRound(middle[0] + factor * (p[0] - middle[0])),
                     cvRound(middle[1] + factor * (p[1] - middle[1])));
  return out;
}

cv::Mat inside(const cv::Size& size, const std::vector<cv::Point>& polygon) {
  cv::Mat mask(size, CV_8U, cv::Scalar(0));
  cv::fillConvexPoly(mask, polygon, cv::Scalar(255));
  return mask;
}

cv::Ptr<cv::SIFT> sift(int features) { return cv::SIFT::create(features); }

/// Features of the plane; if it has few, those around it help, which may lie on the same wall.
PlaneView view_of(const cv::Mat& luminance, const Corners& corners) {
  PlaneView view{luminance.clone(), corners, {}, {}, {}};
  const cv::Mat even = normalized(luminance);
  cv::Mat mask;
  for (const double factor : {1.0, 1.25, 1.6, 2.0}) {
    mask = inside(even.size(), widened(corners, factor));
    const cv::Rect box = cv::boundingRect(mask);
    if (box.empty()) return view;
    const double spacing = std::clamp(std::sqrt(box.area() / double{2 * kMaxFeatures}), 3.0, 12.0);
    cv::goodFeaturesToTrack(even, view.points, kMaxFeatures, 0.05, spacing, mask, 5);
    if (view.points.size() >= 40) break;
  }
  sift(kMaxKeypoints)
      ->detectAndCompute(eight_bits(luminance), mask, view.keypoints, view.descriptors);
  return view;
}

/// Whether a homography shows the plane from the same side, at a size that can be.
bool plausible(const cv::Matx33d& h, const PlaneView& view, const cv::Size& picture) {
  for (const Point& p : view.corners)
    if (!(h(2, 0) * p[0] + h(2, 1) * p[1] + h(2, 2) > 0)) return false;
  const Corners seen = mapped(h, view.corners);
  if (!wrong_corners(seen).empty()) return false;
  const double area = area_of(seen), before = area_of(view.corners);
  if (!(area * before > 0) || std::abs(area) < 64) return false;
  const double longest = kMaxScale * (picture.width + picture.height);
  for (size_t i = 0; i < 4; ++i)
    if (std::hypot(seen[i][0] - seen[(i + 1) % 4][0], seen[i][1] - seen[(i + 1) % 4][1]) > longest)
      return false;
  std::vector<cv::Point2f> quad,
      frame{{0, 0},
            {static_cast<float>(picture.width), 0},
            {static_cast<float>(picture.width), static_cast<float>(picture.height)},
            {0, static_cast<float>(picture.height)}},
      common;
  for (const Point& p : seen) quad.push_back(opencv_point(p));
  return cv::intersectConvexConvex(quad, frame, common) > 0;
}

/// The points of the view that are in the picture under `h`, and where.
void visible(const PlaneView& view, const cv::Matx33d& h, const cv::Size& picture,
             std::vector<cv::Point2f>& points, std::vector<cv::Point2f>& places) {
  constexpr float kBorder = 4;
  for (const cv::Point2f& p : view.points) {
    if (!(h(2, 0) * p.x + h(2, 1) * p.y + h(2, 2) > 0)) continue;
    const cv::Point2f at = mapped(h, p);
    if (at.x < kBorder || at.y < kBorder || at.x > static_cast<float>(picture.width) - kBorder ||
        at.y > static_cast<float>(picture.height) - kBorder)
      continue;
    points.push_back(p);
    places.push_back(at);
  }
}

}  // namespace

void PlaneTracker::set(const cv::Mat& luminance, const Corners& corners) {
  reference_ = view_of(luminance, corners);
  before_ = normalized(luminance);
  to_picture_ = cv::Matx33d::eye();
  const bool enough = reference_->points.size() >= kMinFeatures;
  const auto features = static_cast<unsigned>(reference_->points.size());
  result_ = {enough ? State::found : State::fixed, corners, features, features, 0};
}

void PlaneTracker::set_poster(const cv::Mat& luminance) {
  if (luminance.empty()) {
    poster_.reset();
    return;
  }
  const double w = luminance.cols, h = luminance.rows;
  poster_ = view_of(luminance, {{{0, 0}, {w, 0}, {w, h}, {0, h}}});
}

void PlaneTracker::forget() {
  reference_.reset();
  before_.release();
  may_stay_ = false;
  result_ = {};
}

void PlaneTracker::cut() {
  may_stay_ = result_.state == State::found || (may_stay_ && result_.state == State::lost);
  if (result_.state == State::found) result_.state = State::lost;
  before_.release();
  waited_ = kSearchInterval;
  searches_ = 0;
}

std::optional<PlaneTracker::Pose> PlaneTracker::follow(const cv::Mat& now) const {
  std::vector<cv::Point2f> points, places, moved;
  visible(*reference_, to_picture_, now.size(), points, places);
  if (points.size() < kMinInliers || before_.size() != now.size()) return {};
  std::vector<uchar> good;
  std::vector<float> errors;
  cv::calcOpticalFlowPyrLK(before_, now, places, moved, good, errors, {21, 21}, 4, kStop);
  std::vector<cv::Point2f> from, to;
  for (size_t i = 0; i < points.size(); ++i)
    if (good[i]) {
      from.push_back(points[i]);
      to.push_back(moved[i]);
    }
  if (from.size() < kMinInliers) return {};
  std::vector<uchar> inliers;
  const cv::Mat h = cv::findHomography(from, to, cv::RANSAC, kGross, inliers, 1000, 0.995);
  if (h.empty()) return {};
  Pose pose{cv::Matx33d(h), static_cast<unsigned>(std::count(inliers.begin(), inliers.end(), 1)),
            0};
  if (pose.inliers < kMinInliers || !plausible(pose.to_picture, *reference_, now.size())) return {};
  return pose;
}

std::optional<PlaneTracker::Pose> PlaneTracker::refine(const PlaneView& view,
                                                       const cv::Mat& luminance, const cv::Mat& now,
                                                       const Pose& start) const {
  Pose pose = start;
  for (int round = 0; round < kRefinements; ++round) {
    std::vector<cv::Point2f> points, places;
    visible(view, pose.to_picture, now.size(), points, places);
    if (points.size() < kMinInliers) return {};
    // Only where points are, with room for the window that evens out light.
    cv::Rect box = cv::boundingRect(places);
    constexpr int kRoom = kNormalization + 16;
    box = cv::Rect(box.x - kRoom, box.y - kRoom, box.width + 2 * kRoom, box.height + 2 * kRoom) &
          cv::Rect({0, 0}, now.size());
    const cv::Matx33d shift(1, 0, -box.x, 0, 1, -box.y, 0, 0, 1);
    cv::Mat expected = luminance(box).clone();
    cv::warpPerspective(view.luminance, expected, cv::Mat(shift * pose.to_picture), box.size(),
                        cv::INTER_LINEAR, cv::BORDER_TRANSPARENT);
    for (cv::Point2f& p : places) p -= cv::Point2f(box.tl());
    std::vector<cv::Point2f> moved = places;
    std::vector<uchar> good;
    std::vector<float> errors;
    cv::calcOpticalFlowPyrLK(normalized(expected), now(box), places, moved, good, errors, {15, 15},
                             round == 0 ? 1 : 0, kStop, cv::OPTFLOW_USE_INITIAL_FLOW);
    std::vector<cv::Point2f> from, to;
    for (size_t i = 0; i < points.size(); ++i)
      if (good[i] && cv::norm(moved[i] - places[i]) < kMaxRefinement) {
        from.push_back(points[i]);
        to.push_back(moved[i] + cv::Point2f(box.tl()));
      }
    if (from.size() < kMinInliers) return {};
    std::vector<uchar> inliers;
    const cv::Mat h = cv::findHomography(from, to, cv::RANSAC, kFine, inliers, 2000, 0.995);
    if (h.empty()) return {};
    pose.to_picture = cv::Matx33d(h);
    pose.inliers = 0;
    double sum = 0;
    for (size_t i = 0; i < from.size(); ++i)
      if (inliers[i]) {
        const cv::Point2f off = mapped(pose.to_picture, from[i]) - to[i];
        sum += off.dot(off);
        ++pose.inliers;
      }
    if (pose.inliers < std::max<double>(kMinInliers, kMinInlierShare * double(points.size())) ||
        !plausible(pose.to_picture, view, now.size()))
      return {};
    pose.error = std::sqrt(sum / pose.inliers);
  }
  return pose;
}

bool PlaneTracker::looks_alike(const PlaneView& view, const cv::Mat& luminance, const cv::Mat& now,
                               const Pose& pose) const {
  constexpr int kReach = 7;  // pixels around a point
  constexpr float kAlike = 0.6F;
  cv::Mat expected = luminance.clone();
  cv::warpPerspective(view.luminance, expected, cv::Mat(pose.to_picture), now.size(),
                      cv::INTER_LINEAR, cv::BORDER_TRANSPARENT);
  expected = normalized(expected);
  std::vector<cv::Point2f> points, places;
  visible(view, pose.to_picture, now.size(), points, places);
  const auto alike = std::ranges::count_if(places, [&](const cv::Point2f& place) {
    const cv::Rect around(cvRound(place.x) - kReach, cvRound(place.y) - kReach, 2 * kReach + 1,
                          2 * kReach + 1);
    const cv::Rect inside = around & cv::Rect({0, 0}, now.size());
    cv::Mat correlation;
    cv::matchTemplate(now(inside), expected(inside), correlation, cv::TM_CCOEFF_NORMED);
    return correlation.at<float>(0, 0) > kAlike;
  });
  return 2 * static_cast<size_t>(alike) > places.size();
}

std::optional<PlaneTracker::Pose> PlaneTracker::search(const PlaneView& view,
                                                       const cv::Mat& luminance,
                                                       const cv::Mat& now) {
  if (view.descriptors.rows < static_cast<int>(kMinInliers)) return {};
  if (descriptors_.empty())
    sift(kMaxPictureKeypoints)
        ->detectAndCompute(eight_bits(luminance), cv::noArray(), keypoints_, descriptors_);
  if (descriptors_.rows < static_cast<int>(kMinInliers)) return {};
  std::vector<std::vector<cv::DMatch>> matches;
  cv::BFMatcher(cv::NORM_L2).knnMatch(view.descriptors, descriptors_, matches, 2);
  std::vector<cv::Point2f> from, to;
  for (const auto& match : matches)
    if (match.size() == 2 && match[0].distance < kMatchRatio * match[1].distance) {
      from.push_back(view.keypoints[static_cast<size_t>(match[0].queryIdx)].pt);
      to.push_back(keypoints_[static_cast<size_t>(match[0].trainIdx)].pt);
    }
  if (from.size() < kMinInliers) return {};
  std::vector<uchar> inliers;
  const cv::Mat h = cv::findHomography(from, to, cv::RANSAC, kGross, inliers, 2000, 0.995);
  if (h.empty()) return {};
  const Pose pose{cv::Matx33d(h),
                  static_cast<unsigned>(std::count(inliers.begin(), inliers.end(), 1)), 0};
  if (pose.inliers < kMinInliers || !plausible(pose.to_picture, view, now.size())) return {};
  return refine(view, luminance, now, pose);
}

void PlaneTracker::take(const PlaneView& view, const std::optional<Pose>& pose) {
  result_.features = static_cast<unsigned>(view.points.size());
  result_.inliers = pose ? pose->inliers : 0;
  result_.error = pose ? pose->error : 0;
  result_.state = pose ? State::found : State::lost;
  if (!pose) return;
  to_picture_ = pose->to_picture;
  result_.corners = mapped(pose->to_picture, view.corners);
}

void PlaneTracker::find_again(const cv::Mat& luminance, const cv::Mat& now) {
  if (++waited_ < kSearchInterval) return;
  waited_ = 0;
  descriptors_.release();
  // The poster is searched at first, and in turns when its view is lost.
  if (reference_ && !(poster_ && searches_ % 2 == 1)) {
    if (const auto pose = search(*reference_, luminance, now)) take(*reference_, pose);
  } else if (const auto pose = search(*poster_, luminance, now)) {
    set(luminance, mapped(pose->to_picture, poster_->corners));
    result_.inliers = pose->inliers;
    result_.error = pose->error;
  }
  ++searches_;
}

void PlaneTracker::next(const cv::Mat& luminance) {
  if (result_.state == State::fixed) return;
  const cv::Mat now = normalized(luminance);
  // After a seek to the frame that was shown. Planes of few features have no descriptors.
  if (std::exchange(may_stay_, false) && result_.state == State::lost) {
    const auto pose = refine(*reference_, luminance, now, Pose{to_picture_});
    take(*reference_,
         pose && looks_alike(*reference_, luminance, now, *pose) ? pose : std::nullopt);
  } else if (result_.state == State::found) {
    auto pose = follow(now);
    if (pose) pose = refine(*reference_, luminance, now, *pose);
    take(*reference_, pose);
    if (!pose) {
      waited_ = kSearchInterval;  // at once: it may have moved far
      searches_ = 0;
    }
  }
  if (searches()) find_again(luminance, now);
  before_ = now;
}

}  // namespace inverse
