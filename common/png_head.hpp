// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <string_view>

namespace inverse {

/// What the first bytes of a PNG file say of it.
struct PngHead {
  static constexpr uint64_t kBytes = 24;
  bool png = false;
  uint32_t width = 0, height = 0;

  explicit PngHead(std::string_view file) : png(file.starts_with("\x89PNG")) {
    if (!png || file.size() < kBytes || file.substr(12, 4) != "IHDR") return;
    const auto number = [&](size_t at) {
      uint32_t value = 0;
      for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(file[at + i]);
      return value;
    };
    width = number(16);
    height = number(20);
  }
  /// Of a whole file: 16-bit RGBA that Deflate does not shrink, filters, and what is not pixels.
  uint64_t max_bytes() const { return 9 * (uint64_t{width} * height) + (uint64_t{16} << 20); }
};

}  // namespace inverse
