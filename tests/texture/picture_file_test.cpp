// SPDX-License-Identifier: LGPL-2.1-or-later
// Pictures from files: their kinds, rotation tags, alpha, damage.
#include "gst/base/pictures/picture_file.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
// After cstdio, which it needs.
#include <jpeglib.h>

#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace inverse::testing {
namespace {

using namespace std::string_literals;

void append(void* to, void* data, int size) {
  static_cast<std::string*>(to)->append(static_cast<char*>(data), static_cast<size_t>(size));
}

/// 32 x 16: red and green above, blue and white below.
std::vector<uint8_t> quarters(int channels, uint8_t alpha = 255) {
  constexpr uint8_t kColors[4][3] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 255}};
  std::vector<uint8_t> out;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 32; ++x) {
      const uint8_t* color = kColors[x / 16 + 2 * (y / 8)];
      for (int c = 0; c < channels; ++c) out.push_back(c == 3 ? alpha : color[c]);
    }
  return out;
}
std::string png(int channels, uint8_t alpha = 255) {
  std::string out;
  stbi_write_png_to_func(append, &out, 32, 16, channels, quarters(channels, alpha).data(),
                         32 * channels);
  return out;
}
std::string jpeg() {
  std::string out;
  stbi_write_jpg_to_func(append, &out, 32, 16, 3, quarters(3).data(), 95);
  return out;
}
/// TIFF tags with an orientation, in either order of bytes.
std::string tags(char orientation, bool little) {
  return little
             ? "II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0"s + orientation + "\0\0\0\0\0\0\0"s
             : "MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0"s + orientation + "\0\0\0\0\0\0"s;
}
std::string jpeg_with(const std::string& tiff) {
  const std::string data = "Exif\0\0"s + tiff;
  const size_t length = data.size() + 2;
  return "\xff\xd8\xff\xe1"s + static_cast<char>(length >> 8) + static_cast<char>(length & 255) +
         data + jpeg().substr(2);
}

/// The quarters' colors as letters, row by row, of a picture of any shape.
std::string seen(const Picture8& picture) {
  std::string out;
  for (const uint32_t y : {1U, 3U})
    for (const uint32_t x : {1U, 3U}) {
      const uint64_t n = uint64_t{y * picture.extent.height / 4} * picture.extent.width +
                         x * picture.extent.width / 4;
      const uint8_t* p = &picture.rgba[4 * n];
      const bool r = p[0] > 128, g = p[1] > 128, b = p[2] > 128;
      out += r && g && b ? 'w' : r ? 'r' : g ? 'g' : b ? 'b' : '?';
    }
  return out;
}

}  // namespace

TEST(PictureFile, ReadsKindsAndAlpha) {
  const TemporaryFolder folder;
  const Picture8 rgb = load_picture(folder.write("a.png", png(3)));
  EXPECT_EQ(rgb.extent, (Extent{32, 16}));
  EXPECT_EQ(seen(rgb), "rgbw");
  EXPECT_EQ(rgb.rgba[3], 255);
  const Picture8 rgba = load_picture(folder.write("b.png", png(4, 100)));
  EXPECT_EQ(seen(rgba), "rgbw");
  EXPECT_EQ(rgba.rgba[3], 100);
  EXPECT_EQ(seen(load_picture(folder.write("c.jpg", jpeg()))), "rgbw");
  std::string gray;
  stbi_write_png_to_func(append, &gray, 1, 1, 1, "\x07", 1);
  EXPECT_EQ(load_picture(folder.write("d.png", gray)).rgba, (std::vector<uint8_t>{7, 7, 7, 255}));
}

TEST(PictureFile, TurnsAsItsTagSays) {
  const TemporaryFolder folder;
  // What a viewer shows of "rg / bw" under each tag.
  const char* expected[9] = {"rgbw", "rgbw", "grwb", "wbgr", "bwrg",
                             "rbgw", "brwg", "wgbr", "gwrb"};
  for (int tag = 0; tag <= 8; ++tag)
    for (const bool little : {false, true}) {
      const std::string tiff = tags(static_cast<char>(tag), little);
      const Picture8 picture = load_picture(folder.write("a.jpg", jpeg_with(tiff)));
      EXPECT_EQ(seen(picture), expected[tag]) << tag;
      EXPECT_EQ(picture.extent, tag >= 5 ? (Extent{16, 32}) : (Extent{32, 16})) << tag;
    }
  // A PNG's chunk, in front of its pixels; its checksum is not read.
  const std::string tiff = tags(6, false);
  std::string file = png(3);
  file.insert(33, "\0\0\0"s + static_cast<char>(tiff.size()) + "eXIf" + tiff + "\0\0\0\0"s);
  EXPECT_EQ(seen(load_picture(folder.write("a.png", file))), expected[6]);
  EXPECT_EQ(exif_orientation(jpeg_with(tags(9, true))), 1);
  for (size_t size = 0; size < 60; ++size)
    exif_orientation(jpeg_with(tags(6, true)).substr(0, size));
  for (size_t size = 0; size < tags(6, true).size(); ++size)
    exif_orientation(jpeg_with(tags(6, true).substr(0, size)));
}

TEST(PictureFile, RefusesWhatIsNone) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& name, const std::string& bytes, const char* why) {
    const std::string path = folder.write(name, bytes);
    const std::string text = expect_error(ErrorKind::file, why, [&] { load_picture(path); });
    expect_contains(text, path);
  };
  expect_error(ErrorKind::file, "cannot be read", [&] { load_picture(folder / "none.png"); });
  expect_error(ErrorKind::file, "is no file", [&] { load_picture(folder.path()); });
  expect_error(ErrorKind::file, "not a URI", [&] { load_picture("file:///a.png"); });
  refused("empty.png", "", "no picture");
  refused("text.png", "this is a text", "no picture");
  std::string large = png(3);
  large.replace(16, 8, "\0\0\x4e\x20\0\0\x4e\x20"s);
  refused("large.png", large, "20000x20000 pixels; scale it");
  refused("half.png", png(3).substr(0, png(3).size() / 2), "ends too early");
  refused("half.jpg", jpeg().substr(0, jpeg().size() / 2), "ends too early");
  refused("other.ppm", "P6 1 1 255\n\1\2\3", "no picture");
  // A PNG's head says how wide it is.
  for (const auto& [wide, why] :
       {std::pair("\0\0\x40\0"s, "scale it"), {"\0\0\x20\0"s, "too early"}}) {
    std::string other = png(3);
    other.replace(16, 4, wide).replace(20, 4, wide);
    refused("wide.png", other, why);
  }
  std::string tables = jpeg();
  const size_t at = tables.find("\xff\xc4"s) + 5;
  tables.replace(at, 4, "\xff\xff\xff\xff");
  refused("tables.jpg", tables, "damaged");
  std::string damaged = png(3);
  for (size_t i = 45; i < damaged.size() - 16; ++i) damaged[i] = '\x55';
  refused("damaged.png", damaged, "damaged");
}

TEST(PictureFile, ReadsNoMoreThanAHeaderAllows) {
  const TemporaryFolder folder;
  for (const auto& [bytes, why] : {std::pair(""s, "no picture"),
                                   {"\xff\xd8"s, "no picture"},
                                   {jpeg(), "larger than 128 MiB"},
                                   {png(3), "larger than a picture of 32x16 pixels can be"}}) {
    const std::string path = folder.write("sparse", bytes);
    std::filesystem::resize_file(path, uint64_t{900} << 20);
    expect_error(ErrorKind::file, why, [&] { load_picture(path); });
  }
}

TEST(PictureFile, ReadsInksAndGray) {
  const TemporaryFolder folder;
  // By libjpeg: 8x8 pixels of Adobe CMYK (stored as 255 - ink), and of gray.
  const auto encoded = [](int channels, J_COLOR_SPACE space, std::vector<uint8_t> pixel) {
    jpeg_compress_struct info{};
    jpeg_error_mgr errors{};
    info.err = jpeg_std_error(&errors);
    jpeg_create_compress(&info);
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&info, &bytes, &size);
    info.image_width = info.image_height = 8;
    info.input_components = channels;
    info.in_color_space = space;
    jpeg_set_defaults(&info);
    jpeg_set_quality(&info, 100, TRUE);
    jpeg_start_compress(&info, TRUE);
    std::vector<uint8_t> row;
    for (int x = 0; x < 8; ++x) row.insert(row.end(), pixel.begin(), pixel.end());
    for (int y = 0; y < 8; ++y) {
      JSAMPROW line = row.data();
      jpeg_write_scanlines(&info, &line, 1);
    }
    jpeg_finish_compress(&info);
    jpeg_destroy_compress(&info);
    std::string out(reinterpret_cast<char*>(bytes), size);
    free(bytes);
    return out;
  };
  const auto first = [&](const std::string& bytes) {
    const Picture8 picture = load_picture(folder.write("a.jpg", bytes));
    EXPECT_EQ(picture.extent, (Extent{8, 8}));
    return std::vector<int>(picture.rgba.begin(), picture.rgba.begin() + 4);
  };
  const std::vector<int> inks = first(encoded(4, JCS_CMYK, {200, 100, 50, 255}));
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(inks[c], (std::array{200, 100, 50}[c]), 2);
  const std::vector<int> gray = first(encoded(1, JCS_GRAYSCALE, {77}));
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(gray[c], 77, 1);
  EXPECT_EQ(gray[3], 255);
}

TEST(PictureFile, IsReducedInLinearLight) {
  Picture8 board{{4, 2}, {}};
  for (int n = 0; n < 8; ++n)
    for (int c = 0; c < 4; ++c)
      board.rgba.push_back(c == 3 ? (n < 4 ? 255 : 0) : (n % 2 ? 255 : 0));
  const LinearPicture whole = linear_picture(board, 4);
  EXPECT_EQ(whole.extent, board.extent);
  EXPECT_FLOAT_EQ(whole.rgba[4], 1);
  const LinearPicture half = linear_picture(board, 2);
  ASSERT_EQ(half.extent, (Extent{2, 1}));
  EXPECT_FLOAT_EQ(half.rgba[0], 0.5F) << "transparent pixels have no color";
  EXPECT_FLOAT_EQ(half.rgba[3], 0.5F);
  EXPECT_EQ(linear_picture(board, 3).extent, (Extent{2, 1}));
  EXPECT_EQ(linear_picture(board, 1).extent, (Extent{1, 1}));
}

}  // namespace inverse::testing
