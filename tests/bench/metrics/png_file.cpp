// SPDX-License-Identifier: LGPL-2.1-or-later
#include "png_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "tests/srgb.hpp"

namespace inverse::bench {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw std::runtime_error(path + ": " + what);
}

std::uint32_t big_endian(const std::uint8_t* p) {
  return std::uint32_t(p[0]) << 24 | std::uint32_t(p[1]) << 16 | std::uint32_t(p[2]) << 8 | p[3];
}

/// Undoes the filter of one row (PNG specification, 9.2), in place; `above` is the row before.
void unfilter(int type, std::uint8_t* row, const std::uint8_t* above, std::size_t bytes,
              std::size_t pixel) {
  for (std::size_t i = 0; i < bytes; ++i) {
    const int a = i >= pixel ? row[i - pixel] : 0, b = above[i],
              c = i >= pixel ? above[i - pixel] : 0;
    int predicted = 0;
    if (type == 1) predicted = a;
    if (type == 2) predicted = b;
    if (type == 3) predicted = (a + b) / 2;
    if (type == 4) {
      const int pa = std::abs(b - c), pb = std::abs(a - c), pc = std::abs(a + b - 2 * c);
      predicted = pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
    }
    row[i] = std::uint8_t(row[i] + predicted);
  }
}

std::uint8_t byte_of(float linear) {
  return std::uint8_t(std::lround(255 * srgb_code(std::clamp(linear, 0.0F, 1.0F))));
}

void write_big_endian(std::ostream& out, std::uint32_t v) {
  for (const int shift : {24, 16, 8, 0}) out.put(char(v >> shift & 255));
}

void write_chunk(std::ostream& out, std::string text, const std::vector<std::uint8_t>& data) {
  write_big_endian(out, std::uint32_t(data.size()));
  text.append(data.begin(), data.end());
  out << text;
  write_big_endian(
      out, std::uint32_t(crc32(0, reinterpret_cast<const Bytef*>(text.data()), uInt(text.size()))));
}

}  // namespace

Image read_png(const std::string& path, bool decode_srgb) {
  std::ifstream stream(path, std::ios::binary);
  const std::vector<std::uint8_t> file{std::istreambuf_iterator<char>(stream), {}};
  constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  if (file.size() < 33 || !std::equal(kMagic.begin(), kMagic.end(), file.begin()))
    fail(path, "not a PNG file");
  const int width = int(big_endian(&file[16])), height = int(big_endian(&file[20]));
  const int bits = file[24], color = file[25];
  if ((bits != 8 && bits != 16) || color == 3 || file[28] != 0)
    fail(path, "only 8 or 16 bits without palette and interlacing are read");
  if (width < 1 || height < 1 || width > 1 << 15 || height > 1 << 15) fail(path, "strange size");
  const std::size_t samples = std::size_t(color == 0 ? 1 : color == 2 ? 3 : color == 4 ? 2 : 4);
  std::vector<std::uint8_t> packed;
  for (std::size_t at = 8; at + 12 <= file.size();) {
    const std::size_t length = big_endian(&file[at]);
    if (length > file.size() - at - 12) fail(path, "ends inside a chunk");
    if (!std::memcmp(&file[at + 4], "IDAT", 4))
      packed.insert(packed.end(), &file[at + 8], &file[at + 8] + length);
    at += length + 12;
  }
  const std::size_t pixel = samples * std::size_t(bits) / 8, row = pixel * std::size_t(width);
  std::vector<std::uint8_t> data((row + 1) * std::size_t(height));
  uLongf size = data.size();
  if (uncompress(data.data(), &size, packed.data(), packed.size()) != Z_OK || size != data.size())
    fail(path, "damaged");
  const int kept = color == 0 || color == 4 ? 1 : 3;
  Image image(width, height, kept);
  const std::vector<std::uint8_t> zero(row);
  for (int y = 0; y < height; ++y) {
    std::uint8_t* line = &data[std::size_t(y) * (row + 1)];
    unfilter(line[0], line + 1, y ? line - row : zero.data(), row, pixel);
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < kept; ++c) {
        const std::uint8_t* p =
            line + 1 + std::size_t(x) * pixel + std::size_t(c) * std::size_t(bits) / 8;
        const float code = bits == 8 ? float(*p) / 255 : float(p[0] << 8 | p[1]) / 65535;
        image.at(x, y, c) = bits == 8 && decode_srgb ? srgb_light(code) : code;
      }
  }
  return image;
}

void write_png(const std::string& path, const Image& linear) {
  std::vector<std::uint8_t> rows;
  for (int y = 0; y < linear.height; ++y) {
    rows.push_back(0);  // no filter
    for (int x = 0; x < linear.width; ++x)
      for (int c = 0; c < linear.channels; ++c) rows.push_back(byte_of(linear.at(x, y, c)));
  }
  uLongf size = compressBound(rows.size());
  std::vector<std::uint8_t> packed(size);
  if (compress(packed.data(), &size, rows.data(), rows.size()) != Z_OK)
    fail(path, "cannot be packed");
  packed.resize(size);
  std::vector<std::uint8_t> head;
  for (const int v : {linear.width, linear.height})
    for (const int shift : {24, 16, 8, 0}) head.push_back(std::uint8_t(v >> shift & 255));
  for (const int v : {8, linear.channels == 3 ? 2 : 0, 0, 0, 0}) head.push_back(std::uint8_t(v));
  std::ofstream out(path, std::ios::binary);
  out << "\x89PNG\r\n\x1a\n";
  write_chunk(out, "IHDR", head);
  write_chunk(out, "IDAT", packed);
  write_chunk(out, "IEND", {});
  if (!out.flush()) fail(path, "cannot be written");
}

}  // namespace inverse::bench
