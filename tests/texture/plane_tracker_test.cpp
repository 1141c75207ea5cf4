// SPDX-License-Identifier: LGPL-2.1-or-later
// Following a plane, against the truth of rendered frames.
#include "gst/texture/plane_tracker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "wall_scene.hpp"

namespace inverse::testing {
namespace {

using State = PlaneTracker::State;
const cv::Size kSize(480, 360);

cv::Mat luminance(const cv::Mat& picture) {
  cv::Mat gray, out;
  cv::cvtColor(picture, gray, cv::COLOR_RGB2GRAY);
  gray.convertTo(out, CV_32F, 1 / 255.0);
  return out;
}

}  // namespace

TEST(PlaneTracker, FollowsWithoutDriftBehindAHandAndFindsAgain) {
  const WallScene scene(kSize);
  PlaneTracker tracker;
  EXPECT_EQ(tracker.result().state, State::none);
  double largest = 0, squares = 0;
  int measured = 0, lost_in_view = 0, found_again = -1;
  for (int n = 0; n < WallScene::kFrames; ++n) {
    const WallScene::Frame frame = scene.at(n);
    if (n == 0)
      tracker.set(luminance(frame.picture), frame.corners);
    else
      tracker.next(luminance(frame.picture));
    const bool away = n >= WallScene::kAwayFrom - 15 && n < WallScene::kAwayTo + 20;
    const bool found = tracker.result().state == State::found;
    if (n == WallScene::kAwayFrom + 25) {
      EXPECT_EQ(tracker.result().state, State::lost);
    }
    if (found && found_again < 0 && n > WallScene::kAwayFrom + 25) found_again = n;
    if (away) continue;
    lost_in_view += !found;
    if (!found) continue;
    const double error = corner_error(tracker.result().corners, frame.corners);
    EXPECT_LT(error, 2) << n;
    largest = std::max(largest, error);
    squares += error * error;
    ++measured;
  }
  RecordProperty("rms", std::to_string(std::sqrt(squares / measured)));
  EXPECT_LT(std::sqrt(squares / measured), 0.4) << "largest " << largest;
  EXPECT_EQ(lost_in_view, 0);
  EXPECT_GT(found_again, 0);
}

TEST(PlaneTracker, ACutIsLostAndFoundAgain) {
  const WallScene scene(kSize);
  PlaneTracker tracker;
  tracker.set(luminance(scene.at(0).picture), scene.at(0).corners);
  tracker.cut();
  const WallScene::Frame other = scene.at(40);
  tracker.next(luminance(other.picture));
  ASSERT_EQ(tracker.result().state, State::found);
  EXPECT_LT(corner_error(tracker.result().corners, other.corners), 1);
  // To another scene and back, without a word.
  cv::Mat noise(kSize, CV_32F);
  cv::RNG(1).fill(noise, cv::RNG::UNIFORM, 0, 1);
  tracker.next(noise);
  EXPECT_EQ(tracker.result().state, State::lost);
  for (int i = 0; i < 5; ++i) tracker.next(luminance(other.picture));
  ASSERT_EQ(tracker.result().state, State::found);
  EXPECT_LT(corner_error(tracker.result().corners, other.corners), 1);
}

TEST(PlaneTracker, FindsAPosterByItsPicture) {
  const WallScene scene(kSize);
  PlaneTracker tracker;
  tracker.set_poster(luminance(scene.poster()));
  EXPECT_TRUE(tracker.searches());
  cv::Mat noise(kSize, CV_32F);
  cv::RNG(1).fill(noise, cv::RNG::UNIFORM, 0, 1);
  tracker.next(noise);
  EXPECT_EQ(tracker.result().state, State::none);
  for (int n = 0; n < 6; ++n) {
    const WallScene::Frame frame = scene.at(n);
    tracker.next(luminance(frame.picture));
    if (tracker.result().state != State::found) {
      EXPECT_LT(n, 3);
      continue;
    }
    EXPECT_LT(corner_error(tracker.result().corners, frame.corners), 1) << n;
  }
  EXPECT_EQ(tracker.result().state, State::found);
  tracker.set_poster({});
  tracker.forget();
  EXPECT_FALSE(tracker.searches());
}

TEST(PlaneTracker, APlaneWithoutTextureStaysWhereItIs) {
  const cv::Mat flat(kSize, CV_32F, cv::Scalar(0.5));
  PlaneTracker tracker;
  const Corners corners{{{100, 100}, {200, 100}, {200, 200}, {100, 200}}};
  tracker.set(flat, corners);
  EXPECT_EQ(tracker.result().state, State::fixed);
  tracker.next(flat);
  EXPECT_EQ(tracker.result().state, State::fixed);
  EXPECT_EQ(tracker.result().corners, corners);
}

TEST(PlaneTracker, TakesPicturesOfAnySizeAndContent) {
  const Corners corners{{{1, 1}, {30, 2}, {28, 33}, {2, 30}}};
  for (const cv::Size size : {cv::Size(1, 1), {2, 3}, {1, 500}, {500, 1}, {33, 17}, {64, 48}})
    for (const bool noisy : {false, true}) {
      cv::Mat picture(size, CV_32F, cv::Scalar(0.3));
      if (noisy) cv::RNG(2).fill(picture, cv::RNG::UNIFORM, 0, 1);
      PlaneTracker tracker;
      tracker.set_poster(picture);
      tracker.next(picture);
      tracker.set(picture, corners);
      tracker.next(picture);
      tracker.cut();
      for (int i = 0; i < 4; ++i) tracker.next(picture);
      tracker.next(cv::Mat(kSize, CV_32F, cv::Scalar(1)));  // another size
      for (const Point& p : tracker.result().corners)
        EXPECT_TRUE(std::isfinite(p[0]) && std::isfinite(p[1]));
    }
}

}  // namespace inverse::testing
