// SPDX-License-Identifier: LGPL-2.1-or-later
// The size that an error about a limit recommends.
#include "gst/base/pads/largest_size.hpp"

#include <gtest/gtest.h>

#include <string>

namespace inverse::testing {

TEST(LargestSize, IsTheLargestThatFits) {
  for (const Extent asked : {Extent{7680, 4320},
                             {4096, 2160},
                             {32000, 32000},
                             {32767, 1},
                             {1, 32767},
                             {3, 2},
                             {101, 4001}})
    for (const uint64_t pixels : {1U, 4U, 1000U, 65535U, 4'000'000U, 8'388'608U})
      for (const uint64_t known : {pixels, 2 * pixels, uint64_t{1'000'000'000}}) {
        int tries = 0;
        const auto largest = largest_extent(asked, known, [&](Extent extent) {
          ++tries;
          return extent.pixels() <= pixels;
        });
        SCOPED_TRACE(std::to_string(asked.width) + "x" + std::to_string(asked.height) + " in " +
                     std::to_string(pixels));
        EXPECT_LE(tries, 24);
        ASSERT_EQ(largest.has_value(), asked.pixels() > pixels);
        if (!largest) continue;
        EXPECT_LE(largest->pixels(), pixels);
        EXPECT_LE(largest->width, asked.width);
        EXPECT_LE(largest->height, asked.height);
        // A larger one does not: each side may lose a 64th, and a pixel to be even.
        EXPECT_GT(1.02 * (largest->width + 2) * 1.02 * (largest->height + 2),
                  static_cast<double>(pixels));
      }
}

TEST(LargestSize, IsNoneIfNothingFits) {
  EXPECT_FALSE(largest_extent({640, 480}, 1000, [](Extent) { return false; }));
  EXPECT_FALSE(largest_extent({640, 480}, 0, [](Extent) { return false; }));
  EXPECT_FALSE(largest_extent({640, 480}, 1'000'000, [](Extent) { return true; })) << "asked fits";
}

}  // namespace inverse::testing
