// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hdri.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace inverse::lime {
namespace {

struct Picture {
  int width = 0, height = 0;
  std::vector<Vec> pixels;
};

/// A Radiance RGBE picture in the usual order (-Y height +X width), run-length coded by scan line
/// (Ward 1991) or flat.
Picture read_radiance(const std::filesystem::path& path) {
  const auto fail = [&](const char* why) {
    throw std::runtime_error(path.string() + ": " + why +
                             "; give a Radiance .hdr file, -Y +X, 32-bit_rle_rgbe");
  };
  std::ifstream file(path, std::ios::binary);
  std::string line;
  if (!std::getline(file, line) || line.rfind("#?", 0) != 0) fail("not a Radiance file");
  while (std::getline(file, line) && !line.empty()) {
  }
  Picture picture;
  if (!std::getline(file, line) ||
      std::sscanf(line.c_str(), "-Y %d +X %d", &picture.height, &picture.width) != 2)
    fail("unknown orientation");
  if (picture.width < 8 || picture.height < 8 || picture.width > 32767 || picture.height > 32767)
    fail("unusual size");
  const auto width = std::size_t(picture.width);
  std::vector<std::array<std::uint8_t, 4>> row(width);
  picture.pixels.reserve(width * std::size_t(picture.height));
  const auto byte = [&] {
    const int c = file.get();
    if (c < 0) fail("truncated");
    return std::uint8_t(c);
  };
  for (int y = 0; y < picture.height; ++y) {
    std::array<std::uint8_t, 4> head{byte(), byte(), byte(), byte()};
    if (head[0] == 2 && head[1] == 2 && (head[2] << 8 | head[3]) == picture.width) {
      for (std::size_t channel = 0; channel < 4; ++channel)
        for (std::size_t x = 0; x < width;) {
          int count = byte();
          const bool run = count > 128;
          if (run) count -= 128;
          if (count == 0 || x + std::size_t(count) > width) fail("damaged");
          std::uint8_t value = run ? byte() : 0;
          for (int i = 0; i < count; ++i) row[x++][channel] = run ? value : byte();
        }
    } else {
      row[0] = head;
      for (std::size_t x = 1; x < width; ++x) row[x] = {byte(), byte(), byte(), byte()};
    }
    for (const auto& p : row) {
      const float scale = p[3] ? std::ldexp(1.f, int(p[3]) - 136) : 0.f;
      picture.pixels.push_back({scale * float(p[0]), scale * float(p[1]), scale * float(p[2])});
    }
  }
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
