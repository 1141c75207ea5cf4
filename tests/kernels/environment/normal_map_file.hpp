// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tests/temporary_folder.hpp"

namespace inverse::testing {

/// A PNG whose pixels are not compressed; `bytes` are its samples as they lie in the file.
inline std::vector<uint8_t> png(uint32_t width, uint32_t height, uint32_t channels, uint32_t bits,
                                const std::vector<uint8_t>& bytes) {
  std::vector<uint8_t> file{0x89, 'P', 'N', 'G', 13, 10, 26, 10};
  const auto word = [](std::vector<uint8_t>& to, uint32_t v) {
    for (int shift = 24; shift >= 0; shift -= 8) to.push_back(static_cast<uint8_t>(v >> shift));
  };
  const auto chunk = [&](const char* name, const std::vector<uint8_t>& data) {
    word(file, static_cast<uint32_t>(data.size()));
    std::vector<uint8_t> body(name, name + 4);
    body.insert(body.end(), data.begin(), data.end());
    uint32_t crc = ~0U;
    for (const uint8_t b : body) {
      crc ^= b;
      for (int k = 0; k < 8; ++k) crc = crc & 1 ? 0xedb88320U ^ (crc >> 1) : crc >> 1;
    }
    file.insert(file.end(), body.begin(), body.end());
    word(file, ~crc);
  };
  std::vector<uint8_t> header;
  word(header, width);
  word(header, height);
  const uint8_t kind = channels == 1 ? 0 : channels == 3 ? 2 : 6;
  header.insert(header.end(), {static_cast<uint8_t>(bits), kind, 0, 0, 0});
  chunk("IHDR", header);
  std::vector<uint8_t> data{0x78, 1};
  const size_t row = size_t{width} * channels * bits / 8;
  uint32_t a = 1, b = 0;
  for (size_t y = 0; y * row < bytes.size(); ++y) {
    const size_t count = std::min(row, bytes.size() - y * row) + 1;
    const bool last = (y + 1) * row >= bytes.size();
    for (const size_t v :
         {size_t{last}, count & 255, count >> 8, ~count & 255, (~count >> 8) & 255})
      data.push_back(static_cast<uint8_t>(v));
    data.push_back(0);
    data.insert(data.end(), bytes.begin() + static_cast<ptrdiff_t>(y * row),
                bytes.begin() + static_cast<ptrdiff_t>(y * row + count - 1));
    for (size_t i = data.size() - count; i < data.size(); ++i) {
      a = (a + data[i]) % 65521;
      b = (b + a) % 65521;
    }
  }
  word(data, b << 16 | a);
  chunk("IDAT", data);
  chunk("IEND", {});
  return file;
}

/// A file for a normal map, removed with this object.
class NormalMapPath {
 public:
  std::string path() const { return folder_ / "normals.png"; }
  void write(const std::vector<uint8_t>& bytes) const {
    folder_.write("normals.png", std::as_bytes(std::span(bytes)));
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace inverse::testing
