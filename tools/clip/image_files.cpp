// SPDX-License-Identifier: LGPL-2.1-or-later
#include "image_files.hpp"

#include <zlib.h>

#include <array>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace inverse::clip {
namespace {

void append_big_endian(std::vector<uint8_t>& bytes, uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<uint8_t>(value >> shift));
  }
}

void append_chunk(std::vector<uint8_t>& file, std::string_view type,
                  const std::vector<uint8_t>& data) {
  append_big_endian(file, static_cast<uint32_t>(data.size()));
  size_t start = file.size();
  file.insert(file.end(), type.begin(), type.end());
  file.insert(file.end(), data.begin(), data.end());
  uLong checksum = crc32(0, file.data() + start, static_cast<uInt>(file.size() - start));
  append_big_endian(file, static_cast<uint32_t>(checksum));
}

uint8_t paeth(int left, int up, int up_left) {
  int estimate = left + up - up_left;
  int a = std::abs(estimate - left), b = std::abs(estimate - up), c = std::abs(estimate - up_left);
  return static_cast<uint8_t>(a <= b && a <= c ? left : b <= c ? up : up_left);
}

/// `samples`: the image's bytes, rows of width · 3 · depth / 8 bytes (PNG, ISO/IEC 15948).
void write_png(const std::filesystem::path& path, const std::vector<uint8_t>& samples, int width,
               int height, int depth) {
  size_t pixel = static_cast<size_t>(3 * depth / 8), stride = pixel * width;
  std::vector<uint8_t> filtered;
  filtered.reserve(samples.size() + height);
  for (int y = 0; y < height; ++y) {
    const uint8_t* row = samples.data() + y * stride;
    filtered.push_back(4);  // Paeth
    for (size_t i = 0; i < stride; ++i) {
      int left = i >= pixel ? row[i - pixel] : 0, up = y ? row[i - stride] : 0;
      int up_left = y && i >= pixel ? row[i - pixel - stride] : 0;
      filtered.push_back(static_cast<uint8_t>(row[i] - paeth(left, up, up_left)));
    }
  }
  uLongf size = compressBound(static_cast<uLong>(filtered.size()));
  std::vector<uint8_t> packed(size);
  if (compress2(packed.data(), &size, filtered.data(), static_cast<uLong>(filtered.size()), 9) !=
      Z_OK) {
    throw std::runtime_error("zlib could not compress " + path.string());
  }
  packed.resize(size);

  std::vector<uint8_t> file{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}, header;
  append_big_endian(header, static_cast<uint32_t>(width));
  append_big_endian(header, static_cast<uint32_t>(height));
  header.insert(header.end(), {static_cast<uint8_t>(depth), 2, 0, 0, 0});  // truecolor
  append_chunk(file, "IHDR", header);
  append_chunk(file, "IDAT", packed);
  append_chunk(file, "IEND", {});
  write_bytes(path, file.data(), file.size());
}

}  // namespace

float encode_srgb(float v) {
  return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
}

float encode_video(float v) { return v < 0.018f ? 4.5f * v : 1.099f * std::pow(v, 0.45f) - 0.099f; }

std::vector<uint8_t> to_bytes(const std::vector<Vec3>& image, Transfer transfer) {
  std::vector<uint8_t> bytes;
  bytes.reserve(image.size() * 3);
  for (Vec3 color : image) {
    for (int c = 0; c < 3; ++c) {
      float encoded = transfer(std::clamp(color[c], 0.0f, 1.0f));
      bytes.push_back(static_cast<uint8_t>(std::lround(encoded * 255)));
    }
  }
  return bytes;
}

void write_png8(const std::filesystem::path& path, const std::vector<Vec3>& image, int width,
                int height) {
  write_png(path, to_bytes(image, encode_srgb), width, height, 8);
}

void write_png16(const std::filesystem::path& path, const std::vector<Vec3>& image, int width,
                 int height, float scale) {
  std::vector<uint8_t> samples;
  samples.reserve(image.size() * 6);
  for (Vec3 color : image) {
    for (int c = 0; c < 3; ++c) {
      auto code = std::lround(std::clamp(color[c] * scale, 0.0f, 1.0f) * 65535);
      samples.push_back(static_cast<uint8_t>(code >> 8));
      samples.push_back(static_cast<uint8_t>(code));
    }
  }
  write_png(path, samples, width, height, 16);
}

void write_bytes(const std::filesystem::path& path, const void* data, size_t size) {
  std::ofstream out(path, std::ios::binary);
  out.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
  out.close();
  if (!out) throw std::runtime_error("cannot write " + path.string());
}

}  // namespace inverse::clip
