// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene_files.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace inverse::training {
namespace {

constexpr std::int32_t kMaxSide = 4096;

/// Passes every value of the scene in the order of the file.
template <typename S, typename F>
void each_value(S& s, const F& visit) {
  for (std::size_t i = 0; i < s.mask.data.size(); ++i) {
    for (auto* image : {&s.input, &s.reflectance, &s.shading})
      for (std::size_t c = 0; c < 3; ++c) visit(image->data[3 * i + c]);
    visit(s.mask.data[i]);
  }
}

}  // namespace

void save_scene(const Scene& scene, const std::string& path) {
  std::vector<float> values;
  each_value(scene, [&](float v) { values.push_back(v); });
  const std::array<std::int32_t, 2> size{scene.mask.width, scene.mask.height};
  std::ofstream f(path, std::ios::binary);
  f.write(reinterpret_cast<const char*>(size.data()), sizeof size);
  f.write(reinterpret_cast<const char*>(values.data()),
          std::streamsize(values.size() * sizeof(float)));
  if (!f.flush()) throw std::runtime_error("cannot write " + path);
}

Scene load_scene(const std::string& path) {
  std::ifstream f(path, std::ios::binary);
  std::array<std::int32_t, 2> size{};
  f.read(reinterpret_cast<char*>(size.data()), sizeof size);
  const auto [w, h] = size;
  if (!f || w < 1 || h < 1 || w > kMaxSide || h > kMaxSide)
    throw std::runtime_error(path + " holds no scene");
  Scene s{bench::Image(w, h, 3), bench::Image(w, h, 3), bench::Image(w, h, 3),
          bench::Image(w, h, 1)};
  std::vector<float> values(10 * s.mask.data.size());
  if (!f.read(reinterpret_cast<char*>(values.data()),
              std::streamsize(values.size() * sizeof(float))))
    throw std::runtime_error(path + " is cut short");
  auto next = values.cbegin();
  each_value(s, [&](float& v) { v = *next++; });
  return s;
}

std::vector<std::string> scene_files(const std::string& directory) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(directory))
    if (entry.path().extension() == ".scene") files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace inverse::training
