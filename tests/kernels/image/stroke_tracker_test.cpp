// SPDX-License-Identifier: LGPL-2.1-or-later
// Strokes that follow what they lie on: against tests/reference/image/strokes.*, and on known
// motion.
#include "kernels/image/strokes/stroke_tracker.hpp"

#include <bit>
#include <complex>
#include <functional>

#include "strokes_fixture.hpp"

namespace inverse::testing {
namespace {

using Complex = std::complex<double>;
using Kind = Stroke::Kind;
using State = StrokeTracker::State;
using reference::StrokeMove;

const Extent kFrame{200, 150};

/// Smooth texture without repeats, about .1 to .9.
double texture(Complex p, int which) {
  double sum = .5;
  for (int k = 0; k < 8; ++k) {
    const double angle = 1.3 * k + which, period = 7 + 3.7 * k;
    sum +=
        .12 * std::sin(6.283 / period * (p.real() * std::cos(angle) + p.imag() * std::sin(angle)) +
                       2.1 * k * k + which);
  }
  return std::clamp(sum, .02, 1.0);
}

/// Where a thing is: from `center` to center + shift + turn u.
Complex placed(const StrokeMove& move, Complex p) {
  return move.center + move.shift + move.turn * (p - move.center);
}

/// A disk of texture that moves over a wall of another.
struct Disk {
  StrokeMove move;
  double radius = 30;
  int texture = 1;
};

Pixels picture(Extent extent, const std::vector<Disk>& disks, double light = 1, double noise = 0,
               unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> error(0, 1);
  Pixels pixels(extent.pixels() * 4, 1);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      double value = .5 * texture({x + .5, y + .5}, 40);
      for (const Disk& disk : disks) {
        const Complex drawn =
            disk.move.center +
            (Complex(x + .5, y + .5) - disk.move.center - disk.move.shift) / disk.move.turn;
        if (std::abs(drawn - disk.move.center) < disk.radius) value = texture(drawn, disk.texture);
      }
      for (size_t c = 0; c < 3; ++c)
        pixels[4 * (size_t{y} * extent.width + x) + c] =
            float(std::max(light * value + noise * error(random), 0.0));
    }
  return pixels;
}

Stroke stroke_at(Complex p, float radius) {
  return {Kind::shading,
          {{float(p.real()) - radius / 2, float(p.imag())},
           {float(p.real()) + radius / 2, float(p.imag())}},
          radius};
}

class StrokeTrackerTest : public GpuTest {
 protected:
  void follow(StrokeTracker& tracker, const StrokesPtr& list, const Pixels& pixels) {
    const PlanePtr frame = shared_plane(tracker.extent(), pixels);
    run([&](gpu::Commands& commands) { tracker.record(commands, list, *frame); });
    poses_ = download(tracker.poses());
  }
  StrokeTracker::Pose pose(const StrokeTracker& tracker, const Stroke& stroke) const {
    return StrokeTracker::read(poses_, tracker.slot_of(stroke).index);
  }
  StrokeMove move(const StrokeTracker& tracker, const Stroke& stroke) const {
    const auto at = pose(tracker, stroke);
    const auto center = tracker.slot_of(stroke).center;
    return {{double(center[0]), double(center[1])},
            {double(at.turn[0]), double(at.turn[1])},
            {double(at.shift[0]), double(at.shift[1])}};
  }
  /// How far the ends of a stroke are from where they belong, in pixels.
  double error(const StrokeTracker& tracker, const Stroke& stroke, const StrokeMove& truth) const {
    double worst = 0;
    for (const Stroke::Point& point : stroke.points) {
      const Complex p{double(point[0]), double(point[1])};
      worst = std::max(worst, std::abs(placed(move(tracker, stroke), p) - placed(truth, p)));
    }
    return worst;
  }
  /// Follows a stroke on a disk that moves so for 30 frames; the largest error.
  double largest_error(const std::function<StrokeMove(int t)>& moves, double noise = .01) {
    StrokeTracker tracker(device, kFrame);
    const Stroke stroke = stroke_at(moves(0).center, 12);
    const auto list = std::make_shared<StrokeList>(StrokeList{{stroke}, kFrame});
    double worst = 0;
    for (int t = 0; t <= 30; ++t) {
      follow(tracker, list, picture(kFrame, {{moves(t)}}, 1, noise, unsigned(t)));
      EXPECT_EQ(pose(tracker, stroke).state, State::followed) << "frame " << t;
      worst = std::max(worst, error(tracker, stroke, moves(t)));
    }
    return worst;
  }
  Pixels poses_;
};

TEST_F(StrokeTrackerTest, AgreesWithReference) {
  for (const Extent extent : {Extent{1, 1}, {17, 40}, {101, 67}, {200, 150}}) {
    const double w = extent.width, h = extent.height;
    const auto radius = float(.06 * std::min(w, h) + 1);
    const Stroke one = stroke_at({.3 * w, .5 * h}, radius),
                 other = stroke_at({.8 * w, .4 * h}, radius);
    const auto list = std::make_shared<StrokeList>(StrokeList{{one, other}, extent});
    std::vector<reference::StrokeTrack> expected;
    for (const Stroke& stroke : list->strokes) {
      const StrokeSamples samples = samples_of(stroke, extent, extent);
      std::vector<reference::StrokeTrack::Sample> at;
      for (const auto& sample : samples.samples)
        at.push_back({{double(sample[0]), double(sample[1])}, double(sample[2])});
      expected.emplace_back(at, Complex(double(samples.center[0]), double(samples.center[1])),
                            double(samples.radius), int(samples.levels));
    }
    StrokeTracker tracker(device, extent);
    bool moved = false;
    for (int t = 0; t < 12; ++t) {
      const Disk disk{{{.3 * w, .5 * h}, std::polar(1 + .02 * t, .05 * t), {.012 * w * t, .5 * t}},
                      .2 * std::min(w, h) + 2};
      Pixels pixels = picture(extent, {disk}, 1 - .03 * t, .01, unsigned(t));
      if (t > 8) {  // What no camera sends.
        constexpr std::array kOdd{std::numeric_limits<float>::quiet_NaN(),
                                  std::numeric_limits<float>::infinity(), -1e30F, 1e30F};
        for (size_t i = 0; i < pixels.size(); i += 37) pixels[i] = kOdd[i % 4];
      }
      std::vector<double> rgb;
      for (size_t i = 0; i < pixels.size(); ++i) {
        if (i % 4 == 3) continue;
        // As kernels read it.
        rgb.push_back(std::isnan(pixels[i]) ? 0 : std::clamp(double(pixels[i]), 0.0, 65504.0));
      }
      follow(tracker, list, pixels);
      for (size_t k = 0; k < 2; ++k) {
        expected[k].follow(rgb, int(extent.width), int(extent.height));
        const StrokeMove got = move(tracker, list->strokes[k]), want = expected[k].move();
        const std::string what =
            name_of(extent) + ", stroke " + std::to_string(k) + ", frame " + std::to_string(t);
        ASSERT_EQ(int(pose(tracker, list->strokes[k]).state), int(expected[k].state())) << what;
        ASSERT_LT(std::abs(got.shift - want.shift), .02) << what;
        ASSERT_LT(std::abs(got.turn - want.turn), .002) << what;
        moved = moved || std::abs(want.shift) > 5;
      }
    }
    EXPECT_TRUE(moved || extent.width < 100);
  }
}

TEST_F(StrokeTrackerTest, FollowsAShiftOf5PixelsAFrame) {
  EXPECT_LT(largest_error([](int t) -> StrokeMove {
              // To the right, and back: 15 frames each.
              return {{50, 60}, 1, {5.0 * (t <= 15 ? t : 30 - t), .7 * t}};
            }),
            1);
}

TEST_F(StrokeTrackerTest, FollowsTurnsAndScale) {
  EXPECT_LT(largest_error([](int t) -> StrokeMove {
              return {{100, 75}, std::polar(1.0, .04 * t), {.5 * t, 0}};
            }),
            1);
  EXPECT_LT(largest_error([](int t) -> StrokeMove {
              return {{100, 75}, std::pow(1.012, t), {0, .3 * t}};
            }),
            1);
  EXPECT_LT(largest_error([](int t) -> StrokeMove {
              return {{100, 75}, std::pow(.99, t), {0, 0}};
            }),
            1);
}

TEST_F(StrokeTrackerTest, StaysWhereNothingMoves) {
  StrokeTracker tracker(device, kFrame);
  const Disk disk{{{90, 70}}};
  const Stroke stroke = stroke_at({90, 70}, 12);
  const auto list = std::make_shared<StrokeList>(StrokeList{{stroke}, kFrame});
  int frames_moved = 0;
  for (int t = 0; t < 300; ++t) {
    // Light that changes slowly, too.
    follow(tracker, list, picture(kFrame, {disk}, .8 + .2 * std::cos(.05 * t), .02, unsigned(t)));
    ASSERT_LT(error(tracker, stroke, disk.move), .15) << "frame " << t;
    const Pixels moved = download(tracker.moved());
    frames_moved +=
        std::bit_cast<uint32_t>(moved[shaders::image_strokes_track::MOVED_STROKES]) != 0;
  }
  EXPECT_LT(frames_moved, 30) << "masks must rest";
}

TEST_F(StrokeTrackerTest, IsFoundAgainBehindAnOccluder) {
  StrokeTracker tracker(device, kFrame);
  const Stroke stroke = stroke_at({70, 70}, 12);
  const auto list = std::make_shared<StrokeList>(StrokeList{{stroke}, kFrame});
  bool lost = false;
  for (int t = 0; t < 60; ++t) {
    const Disk disk{{{70, 70}, 1, {.3 * t, 0}}};
    // Another one passes in front of it, and covers it whole for a while.
    const Disk before{{{-60, 70}, 1, {5.0 * t, 0}}, 40, 9};
    follow(tracker, list, picture(kFrame, {disk, before}, 1, .005, unsigned(t)));
    if (pose(tracker, stroke).state == State::followed)
      EXPECT_LT(error(tracker, stroke, disk.move), 1.5) << "frame " << t;
    else
      lost = true;
  }
  EXPECT_TRUE(lost);
  EXPECT_EQ(pose(tracker, stroke).state, State::followed);
}

TEST_F(StrokeTrackerTest, TwoMoveApart) {
  StrokeTracker tracker(device, kFrame);
  const Stroke one = stroke_at({60, 75}, 10), other = stroke_at({130, 75}, 10);
  const auto list = std::make_shared<StrokeList>(StrokeList{{one, other}, kFrame});
  for (int t = 0; t < 25; ++t) {
    const Disk left{{{60, 75}, 1, {-1.0 * t, .5 * t}}, 28, 1},
        right{{{130, 75}, std::polar(1.0, .02 * t), {1.2 * t, -1.0 * t}}, 28, 2};
    follow(tracker, list, picture(kFrame, {left, right}, 1, .01, unsigned(t)));
    EXPECT_LT(error(tracker, one, left.move), 1) << t;
    EXPECT_LT(error(tracker, other, right.move), 1) << t;
  }
}

TEST_F(StrokeTrackerTest, OneThatLeavesTheFrameIsNotDrawn) {
  StrokeTracker tracker(device, kFrame);
  StrokeMask mask(device, kFrame);
  const Stroke stroke = stroke_at({150, 70}, 12);
  const auto list = std::make_shared<StrokeList>(StrokeList{{stroke}, kFrame});
  bool was_outside = false;
  for (int t = 0; t < 40; ++t) {
    const Disk disk{{{150, 70}, 1, {6.0 * (t < 20 ? t : 40 - t), 0}}};
    const PlanePtr frame = shared_plane(kFrame, picture(kFrame, {disk}));
    run([&](gpu::Commands& commands) {
      tracker.record(commands, list, *frame);
      if (t == 0)
        mask.set(commands, list, {&tracker});
      else
        mask.follow(commands, {}, nullptr);
    });
    poses_ = download(tracker.poses());
    const auto state = pose(tracker, stroke).state;
    const Pixels drawn = download(mask.pixels());
    const bool any = std::any_of(drawn.begin(), drawn.end(), [](float v) { return v > 0; });
    EXPECT_EQ(any, state == State::followed || state == State::waiting) << t;
    was_outside = was_outside || state == State::outside;
  }
  EXPECT_TRUE(was_outside);
  // After a seek, as drawn.
  tracker.reset();
  follow(tracker, list, picture(kFrame, {{{{150, 70}}}}));
  EXPECT_LT(std::abs(move(tracker, stroke).shift), .1);
}

TEST_F(StrokeTrackerTest, MasksMoveAsTheReferenceDrawsThem) {
  StrokeTracker tracker(device, kFrame);
  const Stroke stroke = stroke_at({60, 70}, 12);
  const auto list = std::make_shared<StrokeList>(StrokeList{{stroke}, kFrame});
  // At full size, and at half.
  const Extent half{100, 75};
  StrokeMask full_mask(device, kFrame), half_mask(device, half);
  for (int t = 0; t < 12; ++t) {
    const Disk disk{{{60, 70}, std::polar(1 + .03 * t, .06 * t), {2.5 * t, 1.0 * t}}};
    const PlanePtr frame = shared_plane(kFrame, picture(kFrame, {disk}));
    run([&](gpu::Commands& commands) {
      tracker.record(commands, list, *frame);
      for (StrokeMask* mask : {&full_mask, &half_mask})
        if (t == 0)
          mask->set(commands, list, {&tracker});
        else
          mask->follow(commands, {}, nullptr);
    });
    poses_ = download(tracker.poses());
    for (const auto& [mask, extent] : {std::pair{&full_mask, kFrame}, {&half_mask, half}}) {
      const double scale = double(extent.width) / kFrame.width;
      StrokeMove moved = move(tracker, stroke);
      moved.center *= scale, moved.shift *= scale;
      const auto expected = reference::draw_strokes(reference_lines(*list, extent), {moved},
                                                    int(extent.width), int(extent.height));
      const Pixels got = download(mask->pixels());
      double worst = 0, sum = 0;
      for (uint32_t y = 0; y < extent.height; ++y)
        for (uint32_t x = 0; x < extent.width; ++x) {
          const double off = std::abs(mask_at(got, extent, x, y).weight -
                                      expected.weight[size_t{y} * extent.width + x]);
          worst = std::max(worst, off), sum += off;
        }
      // Between texels the border's curve is drawn as a line.
      EXPECT_LT(worst, .15) << "frame " << t << ", " << name_of(extent);
      EXPECT_LT(sum / extent.pixels(), .002) << "frame " << t << ", " << name_of(extent);
    }
  }
}

TEST_F(StrokeTrackerTest, OtherStrokesLeaveOneWhereItIs) {
  StrokeTracker tracker(device, kFrame);
  const Stroke one = stroke_at({60, 75}, 10), other = stroke_at({150, 30}, 10);
  const auto first = std::make_shared<StrokeList>(StrokeList{{one}, kFrame}),
             both = std::make_shared<StrokeList>(StrokeList{{other, one}, kFrame}),
             again = std::make_shared<StrokeList>(StrokeList{{one}, kFrame});
  for (int t = 0; t < 18; ++t) {
    const Disk disk{{{60, 75}, 1, {2.0 * t, 0}}};
    follow(tracker, t < 6 ? first : t < 12 ? both : again, picture(kFrame, {disk}));
    EXPECT_LT(error(tracker, one, disk.move), 1) << t;
    if (t >= 6 && t < 12) {
      EXPECT_LT(std::abs(move(tracker, other).shift), .1);
    }
  }
}

TEST_F(StrokeTrackerTest, ABlackBeginningIsNoTemplate) {
  StrokeTracker tracker(device, kFrame);
  const Stroke stroke = stroke_at({60, 70}, 12);
  const auto list = std::make_shared<StrokeList>(StrokeList{{stroke}, kFrame});
  for (int t = 0; t < 3; ++t) {
    follow(tracker, list, Pixels(kFrame.pixels() * 4, 0));
    EXPECT_EQ(pose(tracker, stroke).state, State::waiting);
  }
  for (int t = 0; t < 8; ++t)
    follow(tracker, list, picture(kFrame, {{{{60, 70}, 1, {3.0 * t, 0}}}}));
  EXPECT_EQ(pose(tracker, stroke).state, State::followed);
  EXPECT_LT(error(tracker, stroke, {{60, 70}, 1, {21, 0}}), 1);
  // A cut: another place.
  follow(tracker, list, picture(kFrame, {{{{60, 70}, 1, {24, 0}}, 90, 5}}));
  EXPECT_EQ(pose(tracker, stroke).state, State::lost);
}

}  // namespace
}  // namespace inverse::testing
