// SPDX-License-Identifier: LGPL-2.1-or-later
// OpenEXR files that change while they are read, and files that must not be written over.
#include <ImfRgbaFile.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/new_file.hpp"
#include "gst/exr/environment_file.hpp"
#include "gst/exr/exr_picture.hpp"
#include "gst/exr/exr_stream.hpp"
#include "tests/expect_error.hpp"
#include "tests/replaced_file.hpp"

namespace inverse::testing {
namespace {

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A picture of one value.
std::string exr(int width, int height, float value) {
  const TemporaryFolder folder;
  const std::vector<Imf::Rgba> pixels(static_cast<size_t>(width * height),
                                      Imf::Rgba(value, value, value));
  {
    NewFile made(folder / "a.exr");
    ExrWriter stream(made);
    Imf::RgbaOutputFile file(stream, Imf::Header(width, height), Imf::WRITE_RGB);
    file.setFrameBuffer(pixels.data(), 1, static_cast<size_t>(width));
    file.writePixels(height);
  }
  return contents(folder / "a.exr");
}

}  // namespace

TEST(ExrPicture, SizeAndPixelsAreOfOneOpening) {
  const ReplacedFile file("a.exr", {exr(32, 16, 1), exr(64, 640, 2), exr(64, 640, 3)});
  if (!file.works()) GTEST_SKIP() << "no leases on this file system";
  ExrPicture picture(file.path(), "a picture", 1000);
  EXPECT_EQ(picture.extent(), (Extent{32, 16}));
  EXPECT_EQ(picture.rgb(), std::vector<float>(3 * 32 * 16, 1));
  EXPECT_EQ(file.openings(), 1);
}

TEST(ExrPicture, TruncationAndOtherBytesAfterTheSizeAreErrorsOrPixels) {
  const TemporaryFolder folder;
  const std::string bytes = exr(64, 640, 1), other = exr(16, 8, 2);
  for (const std::string& later : {std::string(), bytes.substr(0, bytes.size() / 2), other,
                                   bytes.substr(0, 400) + std::string(bytes.size(), '\xff')}) {
    const std::string path = folder.write("a.exr", bytes);
    ExrPicture picture(path, "a picture", 1000);
    std::ofstream(path, std::ios::binary) << later;  // the same file
    expect_error(ErrorKind::file, "a picture cannot be read as OpenEXR", [&] { picture.rgb(); });
  }
}

TEST(EnvironmentFile, IsReadFromOneOpening) {
  const std::string radiance = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n";
  for (const std::string& first : {exr(4, 2, 1), radiance + std::string(32, '\x80')}) {
    const ReplacedFile file("map", {first, exr(32, 16, 2), exr(32, 16, 3), exr(32, 16, 4)});
    if (!file.works()) GTEST_SKIP() << "no leases on this file system";
    std::string warning;
    EXPECT_EQ(load_environment(file.path(), warning).extent(), (Extent{4, 2}));
    EXPECT_EQ(file.openings(), 1);
  }
}

TEST(NewFile, OfANameThatIsTakenIsRefused) {
  const TemporaryFolder folder;
  const std::string there = folder.write("there", "somebody's"), link = folder / "link",
                    loose = folder / "loose";
  std::filesystem::create_symlink(there, link);
  std::filesystem::create_symlink(folder / "nowhere", loose);
  for (const std::string& path : {there, link, loose})
    expect_error(ErrorKind::output, path + ": another file or link", [&] { NewFile file(path); });
  EXPECT_EQ(contents(there), "somebody's");
  EXPECT_FALSE(std::filesystem::exists(folder / "nowhere"));
}

TEST(NewFile, AFailedWriteIsAnErrorAtTheEndToo) {
  NewFile file(TemporaryFolder() / "a");
  file.close();
  EXPECT_THROW(file.write(0, "x", 1), Error);
  EXPECT_THROW(file.close(), Error);
}

}  // namespace inverse::testing
