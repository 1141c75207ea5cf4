#include "tests/bench/datasets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "tests/bench/scene.hpp"

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

float srgb_to_linear(float v) {
  return v <= 0.04045F ? v / 12.92F : std::pow((v + 0.055F) / 1.055F, 2.4F);
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

Frame load_mit(const std::string& directory) {
  Frame f;
  f.scene = fs::path(directory).filename().string();
  f.regime = Regime::kMit;
  f.input = to_image(read(directory + "/original.png"), 3);
  f.reflectance = to_image(read(directory + "/reflectance.png"), 3);
  f.shading = to_image(read(directory + "/shading.png"), 1);
  f.mask = to_image(read(directory + "/mask.png"), 1);
  for (float& v : f.mask.data) v = v > 0.5F ? 1.0F : 0.0F;
  return f;
}

Frame load_rendered(const std::string& directory, int index, Regime regime) {
  char number[16];
  std::snprintf(number, sizeof number, "%03d", index);
  const auto path = [&](const char* folder, const char* extension) {
    return directory + "/" + folder + "/" + number + extension;
  };
  Frame f;
  f.scene = fs::path(directory).filename().string();
  f.index = index;
  f.regime = regime;
  f.input = to_image(read(path("I8", ".png")), 3);
  for (float& v : f.input.data) v = srgb_to_linear(v);
  f.reflectance = to_image(read(path("R", ".exr")), 3);
  const Image direct = to_image(read(path("Sdir", ".exr")), 3);
  const Image indirect = to_image(read(path("Sind", ".exr")), 3);
  f.shading = Image(direct.width, direct.height, 1);
  for (int y = 0; y < direct.height; ++y)
    for (int x = 0; x < direct.width; ++x) {
      constexpr std::array<float, 3> kLuminance{0.2126F, 0.7152F, 0.0722F};
      float s = 0;
      for (int c = 0; c < 3; ++c)
        s += kLuminance[std::size_t(c)] * (direct.at(x, y, c) + indirect.at(x, y, c));
      f.shading.at(x, y) = s;
    }
  return f;
}

std::vector<Frame> load_all(const std::string& root, int frames_per_scene) {
  std::vector<Frame> frames;
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

Frame half_size(const Frame& frame) {
  Frame f = frame;
  f.input = halve(frame.input);
  f.reflectance = halve(frame.reflectance);
  f.shading = halve(frame.shading);
  if (!frame.mask.empty()) f.mask = halve(frame.mask, true);
  return f;
}

}  // namespace inverse::bench
