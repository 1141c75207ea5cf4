// SPDX-License-Identifier: LGPL-2.1-or-later
// Files that the metrics and the benchmark read and write.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "flat_file.hpp"
#include "png_file.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/update_max.hpp"

namespace inverse::bench {
namespace {

class Files : public ::testing::Test {
 protected:
  std::string path(const char* name) const { return folder_ / name; }

 private:
  inverse::testing::TemporaryFolder folder_;
};

TEST_F(Files, FlatDumpsComeBackAsTheyWere) {
  Image image(5, 3, 2);
  for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = float(i) / 7;
  write_flat(path("a.f32"), {"scene=x regime=y", {image, image}});
  const FlatFile back = read_flat(path("a.f32"));
  EXPECT_EQ(back.words, "scene=x regime=y");
  ASSERT_EQ(back.frames.size(), 2U);
  EXPECT_EQ(back.frames[1].data, image.data);
  EXPECT_EQ(back.frames[1].channels, 2);
  EXPECT_EQ(channels(image, 1, 1).at(4, 2), image.at(4, 2, 1));
  EXPECT_EQ(stacked({&image, &image}).at(4, 2, 3), image.at(4, 2, 1));
}

TEST_F(Files, PicturesComeBackToHalfACode) {
  Image image(7, 5, 3);
  for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = float(i) / 104;
  image.data[0] = -1, image.data[1] = 2;  // cut
  write_png(path("a.png"), image);
  const Image back = read_png(path("a.png"), true);
  ASSERT_EQ(back.data.size(), image.data.size());
  EXPECT_EQ(back.width, 7);
  EXPECT_EQ(back.data[0], 0);
  EXPECT_EQ(back.data[1], 1);
  for (std::size_t i = 2; i < image.data.size(); ++i)
    EXPECT_NEAR(back.data[i], image.data[i], 0.0046) << i;  // half a code at white: 2.27 / 255 / 2
  write_png(path("gray.png"), channels(image, 2, 1));
  EXPECT_EQ(read_png(path("gray.png"), true).channels, 1);
  EXPECT_THROW(write_png(path("no folder/a.png"), image), std::runtime_error);
}

TEST_F(Files, ThatAreDamagedAreRefused) {
  EXPECT_THROW(read_flat(path("none.f32")), std::runtime_error);
  std::ofstream(path("short.f32")) << "F32 100 100 3 1\nabc";
  EXPECT_THROW(read_flat(path("short.f32")), std::runtime_error);
  std::ofstream(path("other.png")) << "this is no picture at all, though it is long enough for one";
  EXPECT_THROW(read_png(path("other.png"), false), std::runtime_error);
}

// The committed truth of the clip: every pixel is reflectance times shading, which tells whether
// 8-bit sRGB and 16-bit linear codes were read right.
TEST(Png, ReadsTheCommittedTruth) {
  const std::string folder = CLIP_FOLDER;
  const Image input = read_png(folder + "/045_input.png", true),
              reflectance = read_png(folder + "/045_reflectance.png", true),
              shading = read_png(folder + "/045_shading.png", true);
  ASSERT_EQ(input.width, 160);
  ASSERT_EQ(shading.channels, 3);
  double worst = 0, brightest = 0;
  for (std::size_t i = 0; i < input.data.size(); ++i) {
    const double product = double(reflectance.data[i]) * 2 * shading.data[i];
    update_max(worst, std::abs(std::min(product, 1.0) - input.data[i]));
    update_max(brightest, double(input.data[i]));
  }
  EXPECT_LT(worst, 0.02);  // two 8-bit codes at the curve's steep end
  EXPECT_GT(brightest, 0.3);
}

}  // namespace
}  // namespace inverse::bench
