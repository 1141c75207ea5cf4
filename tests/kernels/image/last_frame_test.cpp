// SPDX-License-Identifier: LGPL-2.1-or-later
// Whether frames repeat the one before, without a device.
#include "kernels/image/format/last_frame.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "described_formats.hpp"

namespace inverse::testing {

TEST(LastFrame, IsComparedByteByByteInEveryFormat) {
  const Extent extent{53, 37};
  std::vector<PixelFormat> formats{PixelFormat::rgba,     PixelFormat::rgb,  PixelFormat::gray8,
                                   PixelFormat::nv12,     PixelFormat::i420, PixelFormat::yuy2,
                                   PixelFormat::p010_10le};
  formats.insert(formats.end(), std::begin(kDescribed), std::end(kDescribed));
  for (const PixelFormat& format : formats) {
    std::vector<std::vector<uint8_t>> planes;
    std::vector<LastFrame::Rows> rows;
    for (uint32_t p = 0; p < format.planes; ++p) {
      const size_t stride = row_bytes(format, extent, p) + 5;
      planes.emplace_back(stride * plane_rows(format, extent, p), uint8_t(7));
      rows.push_back({planes[p].data(), static_cast<ptrdiff_t>(stride)});
    }
    LastFrame last(format, extent);
    EXPECT_FALSE(last.repeats(rows)) << "there is nothing to compare the first frame with";
    EXPECT_TRUE(last.repeats(rows));
    planes[0][static_cast<size_t>(rows[0].stride) - 2] ^= 1;  // padding
    EXPECT_TRUE(last.repeats(rows));
    for (uint32_t p = 0; p < planes.size(); ++p) {
      const size_t last_row = plane_rows(format, extent, p) - 1,
                   last_byte = row_bytes(format, extent, p) - 1;
      const auto stride = static_cast<size_t>(rows[p].stride);
      for (const size_t at : {size_t{0}, last_row * stride, last_row * stride + last_byte}) {
        planes[p][at] ^= 1;
        EXPECT_FALSE(last.repeats(rows)) << format.name << ", plane " << p;
        EXPECT_TRUE(last.repeats(rows)) << format.name << ", plane " << p;
      }
    }
    // Upside down: the last row in memory comes first.
    rows[0].data += rows[0].stride * static_cast<ptrdiff_t>(plane_rows(format, extent, 0) - 1);
    rows[0].stride = -rows[0].stride;
    last.repeats(rows);
    EXPECT_TRUE(last.repeats(rows));
    planes[0][0] ^= 1;
    EXPECT_FALSE(last.repeats(rows)) << format.name;
    EXPECT_TRUE(last.repeats(rows));
    last.reset();
    EXPECT_FALSE(last.repeats(rows));
  }
}

TEST(LastFrame, IsRepeatedAfterManyDifferentOnes) {
  const Extent extent{64, 48};
  std::vector<uint8_t> pixels(extent.pixels());
  const LastFrame::Rows rows[] = {{pixels.data(), 64}};
  LastFrame last(PixelFormat::gray8, extent);
  // Film at 30 Hz: every fifth frame repeats one.
  for (int frame = 0; frame < 40; ++frame) {
    if (frame % 5 > 0) ++pixels[64 * 47];
    EXPECT_EQ(last.repeats(rows), frame > 0 && frame % 5 == 0) << frame;
  }
  for (int frame = 0; frame < 40; ++frame) {
    for (uint8_t& pixel : pixels) ++pixel;
    EXPECT_FALSE(last.repeats(rows)) << frame;
  }
  // The first repeat is compared with some rows alone.
  EXPECT_FALSE(last.repeats(rows));
  for (int frame = 0; frame < 4; ++frame) EXPECT_TRUE(last.repeats(rows)) << frame;
  // A change between the rows that are kept while all frames differ.
  for (int frame = 0; frame < 40; ++frame) {
    ++pixels[64 * 47];
    EXPECT_FALSE(last.repeats(rows)) << frame;
  }
  last.repeats(rows);  // the copy may have been of some rows
  EXPECT_TRUE(last.repeats(rows));
}

}  // namespace inverse::testing
