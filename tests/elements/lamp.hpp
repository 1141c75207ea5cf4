// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <ImfRgbaFile.h>

#include <string>
#include <vector>

#include "kernels/environment/environment.hpp"

namespace inverse::testing {

/// Light from the right, as the camera sees it, alone: a square of 2 `reach` pixels of 64 x 32.
inline Environment lamp(size_t reach, float red, float green, float blue) {
  constexpr size_t kWidth = 64, kHeight = 32;
  std::vector<float> rgb(3 * kWidth * kHeight, 0.0F);
  for (size_t y = kHeight / 2 - reach; y < kHeight / 2 + reach; ++y)
    for (size_t x = 3 * kWidth / 4 - reach; x < 3 * kWidth / 4 + reach; ++x) {
      float* c = &rgb[3 * (y * kWidth + x)];
      c[0] = red;
      c[1] = green;
      c[2] = blue;
    }
  return Environment({kWidth, kHeight}, rgb);
}

/// Writes an OpenEXR picture; returns its path.
inline std::string write_exr(const std::string& path, int width,
                             const std::vector<Imf::Rgba>& pixels) {
  const int height = static_cast<int>(pixels.size()) / width;
  Imf::RgbaOutputFile file(path.c_str(), width, height, Imf::WRITE_RGB);
  file.setFrameBuffer(pixels.data(), 1, static_cast<size_t>(width));
  file.writePixels(height);
  return path;
}

}  // namespace inverse::testing
