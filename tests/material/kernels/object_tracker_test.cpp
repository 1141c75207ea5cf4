// SPDX-License-Identifier: LGPL-2.1-or-later
// Where limematerial searches for its object.
#include "kernels/material/object/object_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <vector>

namespace inverse::testing {
namespace {

/// What a network that finds this disc (in pixels of the frame) would say of a square.
std::vector<float> look(const Square& square, uint32_t side, float x, float y, float radius) {
  std::vector<float> probabilities(size_t{side} * side, 0.0F);
  for (uint32_t row = 0; row < side; ++row)
    for (uint32_t column = 0; column < side; ++column) {
      const float px =
          square.x + square.size * (static_cast<float>(column) + .5F) / static_cast<float>(side);
      const float py =
          square.y + square.size * (static_cast<float>(row) + .5F) / static_cast<float>(side);
      probabilities[size_t{row} * side + column] = std::hypot(px - x, py - y) < radius ? .9F : .1F;
    }
  return probabilities;
}

}  // namespace

TEST(ObjectTracker, FindsAnObjectAndStaysWithIt) {
  ObjectTracker tracker({640, 480});
  EXPECT_EQ(tracker.square().size, 640);
  EXPECT_FALSE(tracker.found());
  for (int i = 0; i < 100; ++i) {
    const float x = 150 + 3 * static_cast<float>(i), y = 200;
    const Square square = tracker.square();
    tracker.update(look(square, 64, x, y, 60), 64, 1, square);
    ASSERT_TRUE(tracker.found()) << i;
    EXPECT_NEAR((tracker.box().left + tracker.box().right) / 2, x, 8);
    EXPECT_NEAR(tracker.box().right - tracker.box().left, 120, 16);
    if (i > 2) {
      EXPECT_NEAR(tracker.square().size, 120 / .66F, 30) << i;
      EXPECT_LT(tracker.square().x, x - 60);
      EXPECT_GT(tracker.square().x + tracker.square().size, x + 60);
    }
  }
}

TEST(ObjectTracker, TheSquareIsUnchangedWithTheObject) {
  ObjectTracker tracker({320, 240});
  for (int i = 0; i < 5; ++i)
    tracker.update(look(tracker.square(), 64, 160, 120, 40), 64, 1, Square(tracker.square()));
  const Square square = tracker.square();
  for (int i = 0; i < 20; ++i) {
    tracker.update(look(square, 64, 160 + static_cast<float>(i % 3), 120, 40), 64, 1, square);
    EXPECT_EQ(tracker.square(), square);
  }
  tracker.update(look(square, 64, 160, 120, 40), 64, 1, square);
  tracker.update(look(square, 64, 160, 120, 40), 64, 1, square);
  EXPECT_EQ(tracker.moved(), 0);
}

TEST(ObjectTracker, AJumpIsAnotherObject) {
  ObjectTracker tracker({320, 240});
  const auto see = [&](float x, float radius) {
    const Square square = tracker.square();
    tracker.update(look(square, 64, x, 120, radius), 64, 1, square);
    return tracker.jumped();
  };
  EXPECT_FALSE(see(100, 40)) << "there was none before";
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(see(100 + 4 * static_cast<float>(i), 40)) << i;
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(see(220, 40 + 2 * static_cast<float>(i))) << i;
  tracker.reset();
  for (int i = 0; i < 6; ++i) EXPECT_FALSE(see(150, 30)) << i;
  EXPECT_FALSE(see(150, 8)) << "a part of it, or something behind it";
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(see(150, 30)) << i;
  // Less than a fifth of the smaller one is elsewhere.
  EXPECT_FALSE(see(115, 15)) << "a third of it lies where the other was";
  for (int i = 0; i < 6; ++i) see(150, 30);
  EXPECT_TRUE(see(108, 15)) << "a tenth of it does";
  EXPECT_FALSE(see(108, 15));
  EXPECT_FALSE(see(108, 1e-3F)) << "gone is not elsewhere";
}

TEST(ObjectTracker, ARefinementThatLosesTheObjectIsRejected) {
  // A poster: from afar it is one thing, from near the dots on it are.
  for (const float dot : {30.0F, 0.0F}) {
    ObjectTracker tracker({640, 480});
    int ambiguous = 0;
    for (int i = 0; i < 30; ++i) {
      const Square square = tracker.square();
      tracker.update(look(square, 64, 250, 200, square.size > 500 ? 150 : dot), 64, 1, square);
      ASSERT_TRUE(tracker.found()) << i;
      ambiguous += tracker.ambiguous();
      EXPECT_NEAR(tracker.box().right - tracker.box().left, 300, 24) << i;
    }
    EXPECT_GT(tracker.square().size, 500) << "it rests where all of it is seen";
    EXPECT_EQ(ambiguous, 1);
    // A thing that is gone is gone.
    for (int i = 0; i < 5; ++i)
      tracker.update(look(tracker.square(), 64, 0, 0, 0), 64, 1, Square(tracker.square()));
    EXPECT_FALSE(tracker.found());
    EXPECT_EQ(tracker.square().size, 640);
  }
}

TEST(ObjectTracker, TheLargerOfTwoObjectsIsTracked) {
  ObjectTracker tracker({400, 400});
  auto both = look(tracker.square(), 64, 100, 100, 40);
  const auto other = look(tracker.square(), 64, 300, 300, 60);
  for (size_t i = 0; i < both.size(); ++i) both[i] = std::max(both[i], other[i]);
  tracker.update(both, 64, 1, Square(tracker.square()));
  EXPECT_NEAR((tracker.box().left + tracker.box().right) / 2, 300, 8);
}

TEST(ObjectTracker, OtherObjectsAreForeign) {
  ObjectTracker tracker({400, 300});
  const Square whole = tracker.square();  // 50 pixels beyond the frame above and below
  auto both = look(whole, 64, 250, 150, 60);
  const auto other = look(whole, 64, 100, 150, 30);
  for (size_t i = 0; i < both.size(); ++i) both[i] = std::max(both[i], other[i]);
  tracker.update(both, 64, 1, whole);
  const auto at = [](const std::vector<uint8_t>& points, const Square& square, float x, float y) {
    const float scale = square.size / 64;
    return points[static_cast<size_t>((y - square.y) / scale) * 64 +
                  static_cast<size_t>((x - square.x) / scale)];
  };
  // In an estimate on another square, too.
  for (const Square& square : {whole, Square{60, 20, 260}}) {
    const auto foreign = tracker.foreign(square, 64);
    ASSERT_EQ(foreign.size(), 64u * 64);
    EXPECT_EQ(at(foreign, square, 100, 150), 1);
    EXPECT_EQ(at(foreign, square, 100, 190), 1) << "it may have moved";
    EXPECT_EQ(at(foreign, square, 250, 150), 0);
    EXPECT_EQ(at(foreign, square, 180, 150), 0) << "the object, too";
  }
  EXPECT_EQ(at(tracker.foreign(whole, 64), whole, 250, -30), 1) << "no frame, no object";
  EXPECT_TRUE(tracker.foreign({200, 100, 100}, 64).empty());
  tracker.reset();
  EXPECT_TRUE(tracker.foreign({60, 20, 260}, 64).empty());
}

TEST(ObjectTracker, AFailedRefinementIsTriedAgainLater) {
  // The number of results under way makes no difference.
  for (const size_t under_way : {1u, 3u}) {
    ObjectTracker tracker({640, 480});
    std::deque<Square> results;
    std::vector<int> tries;
    for (int i = 0; i < 1000; ++i) {
      results.push_back(tracker.square());
      if (results.size() < under_way) continue;
      const Square square = results.front();
      results.pop_front();
      tracker.update(look(square, 64, 250, 200, square.size > 500 ? 150 : 0), 64, 1, square);
      ASSERT_TRUE(tracker.found()) << i;
      if (tracker.ambiguous() && (tries.empty() || i > tries.back() + 10)) tries.push_back(i);
    }
    ASSERT_EQ(tries.size(), 5u) << "ever more seldom";
    for (size_t k = 1; k < tries.size(); ++k)
      EXPECT_NEAR(tries[k] - tries[k - 1], 60 << (k - 1), 8) << under_way << " under way";
  }
}

TEST(ObjectTracker, APossibleRefinementIsMade) {
  ObjectTracker tracker({640, 480});
  for (int i = 0; i < 400; ++i) {
    const Square square = tracker.square();
    tracker.update(look(square, 64, 250, 200, square.size > 500 ? 150 : 0), 64, 1, square);
  }
  // What was in the way is gone.
  for (int i = 0; i < 400; ++i)
    tracker.update(look(tracker.square(), 64, 250, 200, 100), 64, 1, Square(tracker.square()));
  EXPECT_NEAR(tracker.square().size, 200 / .66F, 30);
}

TEST(ObjectTracker, SearchesEverywhereAgainAfterALoss) {
  ObjectTracker tracker({640, 360});
  for (int i = 0; i < 4; ++i)
    tracker.update(look(tracker.square(), 32, 300, 200, 50), 32, 1, Square(tracker.square()));
  EXPECT_LT(tracker.square().size, 300);
  const std::vector<float> nothing(32 * 32, .1F),
      invalid(32 * 32, std::numeric_limits<float>::quiet_NaN());
  for (const auto* frame : {&nothing, &invalid, &nothing})
    tracker.update(*frame, 32, 1, Square(tracker.square()));
  EXPECT_FALSE(tracker.found());
  EXPECT_EQ(tracker.square().size, 640);
}

TEST(ObjectTracker, AnObjectThatTheSquareCutsIsFollowedOutward) {
  ObjectTracker tracker({640, 480});
  for (int i = 0; i < 4; ++i)
    tracker.update(look(tracker.square(), 64, 300, 240, 30), 64, 1, Square(tracker.square()));
  float before = tracker.square().size;
  for (int i = 0; i < 6; ++i)
    tracker.update(look(tracker.square(), 64, 300, 240, 150), 64, 1, Square(tracker.square()));
  EXPECT_GT(tracker.square().size, 2 * before);
  EXPECT_NEAR(tracker.box().right - tracker.box().left, 300, 20);
}

TEST(ObjectTracker, WhatIsBeyondTheFrameIsNoObject) {
  ObjectTracker tracker({200, 100});
  // The frame's border is extended in the square, and with it an object that touches it.
  for (int i = 0; i < 6; ++i)
    tracker.update(look(tracker.square(), 64, 100, 100, 60), 64, 1, Square(tracker.square()));
  EXPECT_LE(tracker.box().bottom, 100);
  EXPECT_NEAR(tracker.box().top, 40, 5);
  EXPECT_NEAR(tracker.box().right - tracker.box().left, 120, 10);
  const Square square = tracker.square();
  for (uint32_t row = 0; row < 64; ++row)
    if (square.y + square.size * static_cast<float>(row) / 64 >= 100) {
      EXPECT_EQ(tracker.mask()[row * 64 + 32], 0) << row;
    }
}

TEST(ObjectTracker, SmallAndNeedleShapedFramesHaveASquare) {
  for (const Extent extent : {Extent{1, 1}, Extent{1, 900}, Extent{16, 16}, Extent{7680, 4320}}) {
    ObjectTracker tracker(extent);
    for (int i = 0; i < 3; ++i)
      tracker.update(std::vector<float>(16 * 16, 1.0F), 16, 1, Square(tracker.square()));
    EXPECT_TRUE(tracker.found());
    EXPECT_GT(tracker.square().size, 0);
    EXPECT_LE(tracker.square().size, static_cast<float>(std::max(extent.width, extent.height)));
  }
}

}  // namespace inverse::testing
