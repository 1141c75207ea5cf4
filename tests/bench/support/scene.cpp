// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "tests/bench/metrics/flat_file.hpp"
#include "tests/srgb.hpp"

namespace inverse::bench {
namespace {

constexpr int kChannels = 8;       // I, R, S, mask
constexpr int kLayerChannels = 7;  // direct, indirect, id

std::string blanks(std::string text, char from, char to) {
  std::replace(text.begin(), text.end(), from, to);
  return text;
}

}  // namespace

Scene read_scene(const std::string& path) {
  const FlatFile file = read_flat(path);
  std::map<std::string, std::string> words;
  std::istringstream line(file.words);
  for (std::string word; line >> word;) {
    const std::size_t equals = word.find('=');
    if (equals != std::string::npos) words[word.substr(0, equals)] = word.substr(equals + 1);
  }
  if (!words.count("set") || !words.count("scene") || file.frames.empty() ||
      (file.frames.front().channels != kChannels &&
       file.frames.front().channels != kChannels + kLayerChannels))
    throw std::runtime_error(path + " is not a scene with truth");
  Scene scene{words["set"],
              blanks(words["scene"], '_', ' '),
              blanks(words["regime"], '_', ' '),
              words["video"] == "1",
              {}};
  for (const Image& all : file.frames) {
    TruthFrame frame{channels(all, 0, 3),
                     channels(all, 3, 3),
                     channels(all, 6, 1),
                     channels(all, 7, 1),
                     {},
                     {},
                     {}};
    if (all.channels > kChannels) {
      frame.direct = channels(all, kChannels, 3);
      frame.indirect = channels(all, kChannels + 3, 3);
      frame.id = channels(all, kChannels + 6, 1);
      if (std::all_of(frame.id.data.begin(), frame.id.data.end(), [](float v) { return v < 0; }))
        frame.id = {};
    }
    if (std::all_of(frame.mask.data.begin(), frame.mask.data.end(), [](float v) { return v == 1; }))
      frame.mask = {};
    scene.frames.push_back(std::move(frame));
  }
  return scene;
}

void write_scene(const std::string& folder, const Scene& scene) {
  FlatFile file;
  file.words = "set=" + scene.set + " scene=" + blanks(scene.name, ' ', '_') +
               " regime=" + blanks(scene.regime, ' ', '_') + " video=" + (scene.video ? "1" : "0");
  for (const TruthFrame& frame : scene.frames) {
    const Image all(frame.input.width, frame.input.height, 1, 1.0F);
    const Image no_id(frame.input.width, frame.input.height, 1, -1.0F);
    std::vector<const Image*> parts{&frame.input, &frame.reflectance, &frame.shading,
                                    frame.mask.empty() ? &all : &frame.mask};
    if (!frame.direct.empty())
      parts.insert(parts.end(),
                   {&frame.direct, &frame.indirect, frame.id.empty() ? &no_id : &frame.id});
    file.frames.push_back(stacked(parts));
  }
  std::filesystem::create_directories(folder);
  write_flat(folder + "/" + scene.set + "-" + blanks(scene.name, ' ', '_') + ".f32", file);
}

std::vector<Scene> read_scenes(const std::string& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".f32") paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  std::vector<Scene> scenes;
  for (const std::string& path : paths) scenes.push_back(read_scene(path));
  return scenes;
}

std::size_t to_and_fro(std::size_t k, std::size_t count) {
  if (count < 2) return 0;
  k %= 2 * (count - 1);
  return k < count ? k : 2 * (count - 1) - k;
}

Image halve(const Image& image, bool is_mask) {
  Image out(image.width / 2, image.height / 2, image.channels);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      for (int c = 0; c < image.channels; ++c) {
        const float mean =
            0.25F * (image.at(2 * x, 2 * y, c) + image.at(2 * x + 1, 2 * y, c) +
                     image.at(2 * x, 2 * y + 1, c) + image.at(2 * x + 1, 2 * y + 1, c));
        out.at(x, y, c) = is_mask ? (mean > 0.999F ? 1.0F : 0.0F) : mean;
      }
  return out;
}

Image luminance_of_sum(const Image& a, const Image& b) {
  constexpr float kLuminance[] = {0.2126F, 0.7152F, 0.0722F};
  Image out(a.width, a.height, 1);
  for (std::size_t i = 0; i < out.data.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      out.data[i] += kLuminance[c] * (a.data[3 * i + c] + b.data[3 * i + c]);
  return out;
}

Image through_8_bits(const Image& linear) {
  Image out = linear;
  for (float& v : out.data) {
    v = srgb_light(std::round(std::clamp(srgb_code(v), 0.0F, 1.0F) * 255) / 255);
  }
  return out;
}

Image with_noise(const Image& linear, std::mt19937& random) {
  Image out = linear;
  std::normal_distribution<float> normal;
  for (float& v : out.data) v = std::max(0.0F, v + 0.01F * std::sqrt(v + 0.002F) * normal(random));
  return out;
}

}  // namespace inverse::bench
