// SPDX-License-Identifier: LGPL-2.1-or-later
#include "datasets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "tests/srgb.hpp"

namespace inverse::bench {
namespace {

namespace fs = std::filesystem;

struct Sequence {
  const char* scene;
  Regime regime;
};

constexpr std::array<Sequence, 7> kSequences{{{"cornell", Regime::kNearConstantValue},
                                              {"room", Regime::kNearConstantValue},
                                              {"desk_rgbd", Regime::kNearConstantValue},
                                              {"lightchange", Regime::kHardShadow},
                                              {"courtyard", Regime::kHardShadow},
                                              {"room_values", Regime::kDiverseValue},
                                              {"lightchange_values", Regime::kDiverseValue}}};

cv::Mat read(const std::string& path) {
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 1);
  cv::Mat m = cv::imread(path, cv::IMREAD_UNCHANGED);
  if (m.empty()) throw std::runtime_error("cannot read " + path);
  cv::Mat f;
  const double full = m.depth() == CV_8U ? 255.0 : m.depth() == CV_16U ? 65535.0 : 1.0;
  m.convertTo(f, CV_32F, 1.0 / full);
  return f;
}

/// OpenCV's BGR(A) or gray to interleaved RGB or gray.
Image to_image(const cv::Mat& m, int channels) {
  Image out(m.cols, m.rows, channels);
  const int have = m.channels();
  for (int y = 0; y < m.rows; ++y) {
    const float* row = m.ptr<float>(y);
    for (int x = 0; x < m.cols; ++x)
      for (int c = 0; c < channels; ++c) out.at(x, y, c) = row[x * have + (have >= 3 ? 2 - c : 0)];
  }
  return out;
}

}  // namespace

const char* regime_title(Regime regime) {
  constexpr std::array<const char*, kRegimes> kNames{"MIT objects", "hard shadow",
                                                     "near-constant value", "diverse value"};
  return kNames[std::size_t(regime)];
}

Regime regime_of(const std::string& scene) {
  for (const Sequence& s : kSequences)
    if (scene == s.scene) return s.regime;
  return Regime::kNearConstantValue;
}

int count_frames(const std::string& directory) {
  int n = 0;
  char name[32];
  for (;; ++n) {
    std::snprintf(name, sizeof name, "/I8/%03d.png", n);
    if (!fs::exists(directory + name)) return n;
  }
}

LabeledFrame load_mit(const std::string& directory) {
  LabeledFrame f;
  f.scene = fs::path(directory).filename().string();
  f.regime = Regime::kMit;
  f.input = to_image(read(directory + "/original.png"), 3);
  f.reflectance = to_image(read(directory + "/reflectance.png"), 3);
  f.shading = to_image(read(directory + "/shading.png"), 1);
  f.mask = to_image(read(directory + "/mask.png"), 1);
  for (float& v : f.mask.data) v = v > 0.5F ? 1.0F : 0.0F;
  return f;
}

LabeledFrame load_rendered(const std::string& directory, int index, Regime regime) {
  char number[16];
  std::snprintf(number, sizeof number, "%03d", index);
  const auto path = [&](const char* folder, const char* extension) {
    return directory + "/" + folder + "/" + number + extension;
  };
  LabeledFrame f;
  f.scene = fs::path(directory).filename().string();
  f.index = index;
  f.regime = regime;
  f.input = to_image(read(path("I8", ".png")), 3);
  for (float& v : f.input.data) v = srgb_light(v);
  f.reflectance = to_image(read(path("R", ".exr")), 3);
  f.direct = to_image(read(path("Sdir", ".exr")), 3);
  f.indirect = to_image(read(path("Sind", ".exr")), 3);
  if (fs::exists(path("id", ".png"))) {
    f.id = to_image(read(path("id", ".png")), 1);
    for (float& v : f.id.data) v = std::round(v * 255);
  }
  f.shading = luminance_of_sum(f.direct, f.indirect);
  return f;
}

std::vector<LabeledFrame> load_all(const std::string& root, int frames_per_scene) {
  std::vector<LabeledFrame> frames;
  std::vector<std::string> objects;
  if (!fs::exists(root + "/mit")) throw std::runtime_error("no data set at " + root + "/mit");
  for (const auto& entry : fs::directory_iterator(root + "/mit"))
    if (entry.is_directory()) objects.push_back(entry.path().string());
  std::sort(objects.begin(), objects.end());
  for (const std::string& o : objects) frames.push_back(load_mit(o));
  for (const Sequence& s : kSequences) {
    const std::string directory = root + "/" + s.scene;
    const int n = count_frames(directory);
    const int take = frames_per_scene <= 0 ? n : std::min(n, frames_per_scene);
    for (int k = 0; k < take; ++k) {
      const int index = take == 1 ? n / 2 : k * (n - 1) / (take - 1);
      frames.push_back(load_rendered(directory, index, s.regime));
    }
  }
  return frames;
}

LabeledFrame half_size(const LabeledFrame& frame) {
  LabeledFrame f = frame;
  f.input = halve(frame.input);
  f.reflectance = halve(frame.reflectance);
  f.shading = halve(frame.shading);
  if (!frame.mask.empty()) f.mask = halve(frame.mask, true);
  if (!frame.direct.empty()) f.direct = halve(frame.direct), f.indirect = halve(frame.indirect);
  f.id = {};
  return f;
}

}  // namespace inverse::bench
