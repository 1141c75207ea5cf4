// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "kernels/texture/quad.hpp"

namespace inverse {

/// A picture in which a plane is seen, and what it is recognized by.
struct PlaneView {
  cv::Mat luminance;                ///< CV_32F, 0…1
  Corners corners{};                ///< of the plane, in pixels of it
  std::vector<cv::Point2f> points;  ///< on the plane, that are followed (OpenCV's pixels)
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
};

/// Follows a plane through luminance pictures, from the one in which its corners are known (the
/// reference). No GStreamer, no device.
///
/// From a picture to the next, points of the reference are followed by pyramidal Lucas–Kanade, and
/// give a homography by RANSAC. The reference, warped by it, is then aligned with the picture,
/// again at these points: errors do not add up over pictures. Both compare luminance less its local
/// mean, over its local deviation, so that light may change. A plane that is lost is searched by
/// SIFT descriptors of the reference.
class PlaneTracker {
 public:
  enum class State {
    none,  ///< no plane is known
    found,
    lost,
    fixed  ///< it has too few features: it stays where it is in the picture
  };
  struct Result {
    State state = State::none;
    Corners corners{};  ///< in pixels of the picture
    unsigned features = 0, inliers = 0;
    double error = 0;  ///< rms distance of inliers to the homography, pixels
  };

  /// The plane has these corners in this picture, with which nothing may be wrong
  /// (wrong_corners).
  void set(const cv::Mat& luminance, const Corners& corners);
  /// A picture of what is on the plane: it is searched while no plane is known, or when its view
  /// is not found again. Empty: none.
  void set_poster(const cv::Mat& luminance);
  bool has_poster() const { return poster_.has_value(); }
  /// The next picture, CV_32F, 0…1, of any size.
  void next(const cv::Mat& luminance);
  /// The next picture may have nothing to do with the ones before; the plane is looked for in its
  /// old place first.
  void cut();
  /// Forgets the plane.
  void forget();

  const Result& result() const { return result_; }
  /// Whether a plane that is lost, or never seen, may be found.
  bool searches() const {
    return result_.state == State::lost || (result_.state == State::none && poster_);
  }

  static constexpr int kMinFeatures = 12;

 private:
  struct Pose {
    cv::Matx33d to_picture;  // from the view, in OpenCV's pixels
    unsigned inliers = 0;
    double error = 0;
  };
  static constexpr unsigned kNever = 1000;
  /// From the last picture to this one; empty if it is lost.
  std::optional<Pose> follow(const cv::Mat& now) const;
  /// Aligns the view with a picture; `start` is some pixels off at most.
  std::optional<Pose> refine(const PlaneView& view, const cv::Mat& luminance, const cv::Mat& now,
                             const Pose& start) const;
  /// Whether most of the view's points look as they did, where `pose` has them.
  bool looks_alike(const PlaneView& view, const cv::Mat& luminance, const cv::Mat& now,
                   const Pose& pose) const;
  /// Searches the view in a picture.
  std::optional<Pose> search(const PlaneView& view, const cv::Mat& luminance, const cv::Mat& now);
  void find_again(const cv::Mat& luminance, const cv::Mat& now);
  void take(const PlaneView& view, const std::optional<Pose>& pose);

  std::optional<PlaneView> reference_, poster_;
  cv::Matx33d to_picture_;               // of the reference; if found
  cv::Mat before_;                       // the last picture, normalized
  unsigned waited_ = kNever;             // pictures since the last search
  unsigned searches_ = 0;                // since it was lost
  bool may_stay_ = false;                // a plane that was found before a cut
  std::vector<cv::KeyPoint> keypoints_;  // of the picture that is searched
  cv::Mat descriptors_;
  Result result_;
};

}  // namespace inverse
