// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gst/texture/corners_text.hpp"

#include <gtest/gtest.h>

#include "tests/expect_error.hpp"

namespace inverse::testing {

TEST(CornersText, ReadsWhatItWrites) {
  const Corners corners{{{-10.5, 20}, {200.25, 21}, {199, 150.75}, {11, 149}}};
  EXPECT_EQ(text_of(corners), "-10.50,20.00 200.25,21.00 199.00,150.75 11.00,149.00");
  EXPECT_EQ(read_corners(text_of(corners)), corners);
  EXPECT_EQ(read_corners(" 1,2  3,4\n5,6 ;7,8 "), (Corners{{{1, 2}, {3, 4}, {5, 6}, {7, 8}}}));
  EXPECT_FALSE(read_corners(""));
  EXPECT_FALSE(read_corners(" \n"));
}

TEST(CornersText, RefusesWhatIsNoCorners) {
  for (const char* text :
       {"1,2 3,4 5,6", "1,2 3,4 5,6 7,8 9", "1,2 3,4 5,6 7,x", "1,2 3,4 5,6 7,8z", "corners",
        "1,2 3,4 5,6 7,1e999", "nan,2 3,4 5,6 7,8", "1,2 3,4 5,inf 7,8"})
    expect_error(ErrorKind::unsupported, "four corners", [&] { read_corners(text); });
}

}  // namespace inverse::testing
