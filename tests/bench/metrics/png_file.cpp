// SPDX-License-Identifier: LGPL-2.1-or-later
#include "png_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <vector>

#include "tests/srgb.hpp"

// Private to this file.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_MAX_DIMENSIONS 32768
#define STBI_ONLY_PNG
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace inverse::bench {

Image read_png(const std::string& path, bool decode_srgb) {
  const bool wide = stbi_is_16_bit(path.c_str());
  int width = 0, height = 0, channels = 0;
  // 8-bit codes become multiples of 257.
  const std::unique_ptr<stbi_us, void (*)(void*)> codes(
      stbi_load_16(path.c_str(), &width, &height, &channels, 0), stbi_image_free);
  if (!codes) throw std::runtime_error(path + ": no PNG file (" + stbi_failure_reason() + ")");
  Image image(width, height, channels < 3 ? 1 : 3);
  const stbi_us* pixel = codes.get();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x, pixel += channels)
      for (int c = 0; c < image.channels; ++c) {
        const float code = float(pixel[c]) / 65535;
        image.at(x, y, c) = !wide && decode_srgb ? srgb_light(code) : code;
      }
  return image;
}

void write_png(const std::string& path, const Image& linear) {
  std::vector<std::uint8_t> codes;
  for (const float value : linear.data)
    codes.push_back(std::uint8_t(std::lround(255 * srgb_code(std::clamp(value, 0.0F, 1.0F)))));
  if (!stbi_write_png(path.c_str(), linear.width, linear.height, linear.channels, codes.data(), 0))
    throw std::runtime_error(path + ": cannot be written");
}

}  // namespace inverse::bench
