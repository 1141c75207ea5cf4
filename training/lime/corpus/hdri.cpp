// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hdri.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <stdexcept>

// Private to this file.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_HDR
#define STBI_MAX_DIMENSIONS 32767
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace inverse::lime {
namespace {

struct Picture {
  int width = 0, height = 0;
  std::vector<Vec> pixels;
};

Picture read_radiance(const std::filesystem::path& path) {
  Picture picture;
  int channels = 0;
  const std::unique_ptr<float, void (*)(void*)> values(
      stbi_loadf(path.c_str(), &picture.width, &picture.height, &channels, 3), stbi_image_free);
  if (!values)
    throw std::runtime_error(path.string() + ": " + stbi_failure_reason() +
                             "; give a Radiance .hdr file, -Y +X, 32-bit_rle_rgbe");
  const float* v = values.get();
  for (int i = 0; i < picture.width * picture.height; ++i, v += 3)
    picture.pixels.push_back({v[0], v[1], v[2]});
  return picture;
}

/// Mean over the area of every texel, fractions of pixels included.
Environment resample(const Picture& picture) {
  Environment map{Environment::kRows,
                  std::vector<Vec>(std::size_t(Environment::kRows * Environment::kColumns))};
  const auto overlaps = [](int texel, int texels, int pixels, auto visit) {
    const float low = float(texel) * float(pixels) / float(texels);
    const float high = float(texel + 1) * float(pixels) / float(texels);
    for (int p = int(low); p < pixels && float(p) < high; ++p)
      visit(p, std::min(high, float(p + 1)) - std::max(low, float(p)));
  };
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns(); ++column) {
      Vec sum;
      float weight = 0;
      overlaps(row, map.rows, picture.height, [&](int y, float wy) {
        overlaps(column, map.columns(), picture.width, [&](int x, float wx) {
          sum += wy * wx * picture.pixels[std::size_t(y * picture.width + x)];
          weight += wy * wx;
        });
      });
      map.at(row, column) = (1 / weight) * sum;
    }
  return map;
}

void normalize_mean(Environment& map) {
  double sum = 0, weight = 0;
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns(); ++column) {
      const double w = double(texel_solid_angle(row, map.rows, map.columns()));
      sum += w * double(luminance(map.at(row, column)));
      weight += w;
    }
  for (Vec& e : map.radiance) e = float(weight / std::max(sum, 1e-12)) * e;
}

}  // namespace

std::vector<NamedMap> load_maps(const std::string& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".hdr") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<NamedMap> maps;
  for (const auto& path : paths) {
    const std::string name = path.stem().string();
    const bool held_out =
        std::find(std::begin(kHeldOutMaps), std::end(kHeldOutMaps), name) != std::end(kHeldOutMaps);
    Environment map = resample(read_radiance(path));
    normalize_mean(map);
    maps.push_back({name, held_out, std::move(map)});
  }
  return maps;
}

}  // namespace inverse::lime
