// SPDX-License-Identifier: LGPL-2.1-or-later
#include "normal_map.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace inverse {
namespace {

constexpr const char* kExpected = "a normal map is a PNG, RGB = xyz from -1 to 1, z to the camera";
constexpr float kMinLength = 0.5F, kMaxLength = 1.3F;  // of what counts as a normal
constexpr float kNear = 0.1F;  // of a length to 1, as 8 bits and scaled edges leave it

Normal normalized(const Normal& n) {
  const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (!(n[2] > 0) || !(length > 0)) return {};
  return {n[0] / length, n[1] / length, n[2] / length};
}

}  // namespace

NormalMap NormalMap::load(const std::string& path, std::string& warning) {
  return from(read_png_pixels(path, kExpected), path, warning);
}

NormalMap NormalMap::from(const PngPixels& png, const std::string& path, std::string& warning) {
  warning.clear();
  const auto refuse = [&path](const std::string& why) {
    throw Error(ErrorKind::file, path + ": " + why + "; " + kExpected);
  };
  if (png.gray()) refuse("it is gray");
  const Extent extent = png.extent;
  std::vector<Normal> normals(extent.pixels());
  size_t taken = 0, good = 0;
  for (size_t i = 0; i < normals.size(); ++i) {
    const uint16_t* code = &png.codes[4 * i];
    Normal n{};
    for (size_t c = 0; c < 3; ++c) n[c] = 2 * static_cast<float>(code[c]) / 65535 - 1;
    const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(code[3] >= 32768 && n[2] > 0 && length > kMinLength && length < kMaxLength)) continue;
    normals[i] = normalized(n);
    ++taken;
    good += std::fabs(length - 1) < kNear;
  }
  if (taken == 0) refuse("no normal in it faces the camera");
  if (2 * good < taken)
    warning = path + ": of what it has for normals, " + std::to_string(100 * good / taken) +
              " % have a length near 1; is it a normal map (RGB = xyz from -1 to 1, z to the "
              "camera, not converted to other colors)?";
  return {extent, std::move(normals)};
}

NormalMap::NormalMap(Extent extent, std::vector<Normal> normals)
    : extent_(extent), normals_(std::move(normals)) {
  if (!extent.pixels() || normals_.size() != extent.pixels())
    throw Error(ErrorKind::internal, "a normal map of another size than its normals");
}

Normal NormalMap::at(float x, float y) const {
  const auto axis = [](float place, uint32_t size) {
    const float at = std::clamp(place, 0.0F, 1.0F) * static_cast<float>(size) - 0.5F;
    return std::clamp(at, 0.0F, static_cast<float>(size - 1));
  };
  const float column = axis(x, extent_.width), row = axis(y, extent_.height);
  const auto left = static_cast<uint32_t>(column), top = static_cast<uint32_t>(row);
  const float across = column - static_cast<float>(left), down = row - static_cast<float>(top);
  Normal sum{};
  for (uint32_t k = 0; k < 4; ++k) {
    const uint32_t c = std::min(left + k % 2, extent_.width - 1);
    const uint32_t r = std::min(top + k / 2, extent_.height - 1);
    const float weight = (k % 2 ? across : 1 - across) * (k / 2 ? down : 1 - down);
    const Normal& n = normals_[size_t{r} * extent_.width + c];
    for (size_t i = 0; i < 3; ++i) sum[i] += weight * n[i];
  }
  return normalized(sum);
}

}  // namespace inverse
