// SPDX-License-Identifier: LGPL-2.1-or-later
#include "surface_file.hpp"

#include <utility>

namespace inverse {

SurfaceFile SurfaceFile::load(const std::string& path, std::string& warning) {
  warning.clear();
  const PngPixels png = read_png_pixels(
      path,
      "geometry is a PNG of 8 or 16 bits, gray for depth, RGB for normals (xyz from -1 to 1)");
  if (png.gray()) return SurfaceFile(DepthMap(png, path));
  return SurfaceFile(NormalMap::from(png, path, warning));
}

float SurfaceFile::median() const {
  const auto* depth = std::get_if<DepthMap>(&map_);
  return depth ? depth->median() : 0;
}

std::vector<SurfacePixel> SurfaceFile::surface(Extent frame, float focal_length,
                                               float units) const {
  if (const auto* depth = std::get_if<DepthMap>(&map_))
    return depth->surface(frame, focal_length, units);
  const auto& normals = std::get<NormalMap>(map_);
  std::vector<SurfacePixel> surface(frame.pixels(), {0, 0, 1, 0});
  for (uint32_t y = 0; y < frame.height; ++y)
    for (uint32_t x = 0; x < frame.width; ++x) {
      const Normal n = normals.at((static_cast<float>(x) + .5F) / static_cast<float>(frame.width),
                                  (static_cast<float>(y) + .5F) / static_cast<float>(frame.height));
      if (n[2] > 0) surface[size_t{y} * frame.width + x] = {n[0], -n[1], n[2], 0};
    }
  return surface;
}

}  // namespace inverse
