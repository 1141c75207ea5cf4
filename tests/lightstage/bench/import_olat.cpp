// SPDX-License-Identifier: LGPL-2.1-or-later
// import-olat FROM TO: turns folders of OpenEXR pictures under one light at a time into flat dumps
// for relight-bench. Any folder below FROM that holds lights.json, gradient1.exr, gradient2.exr,
// alpha.png and olat/NNN.exr becomes TO/NAME.f32; lights are brought to the scale of the gradients.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "olat_set.hpp"

namespace inverse::bench {
namespace {

namespace fs = std::filesystem;

Image picture(const fs::path& path, int channels) {
  cv::Mat m = cv::imread(path.string(), cv::IMREAD_UNCHANGED), f;
  if (m.empty()) throw std::runtime_error("cannot read " + path.string());
  m.convertTo(f, CV_32F, m.depth() == CV_8U ? 1 / 255.0 : 1.0);
  Image out(m.cols, m.rows, channels);
  const int have = m.channels();
  for (int y = 0; y < m.rows; ++y)
    for (int x = 0; x < m.cols; ++x)
      for (int c = 0; c < channels; ++c)
        out.at(x, y, c) = f.ptr<float>(y)[x * have + (have >= 3 ? 2 - c : 0)];
  return out;
}

OlatSet load(const fs::path& folder) {
  std::ifstream text(folder / "lights.json");
  const auto lights = nlohmann::json::parse(text);
  OlatSet set;
  set.name = folder.filename().string();
  for (const auto& w : lights.at("directions")) {
    const double x = w.at(0), y = w.at(1), z = w.at(2), length = std::sqrt(x * x + y * y + z * z);
    set.directions.push_back({x / length, y / length, z / length});
  }
  set.a = picture(folder / "gradient1.exr", 3);
  set.b = picture(folder / "gradient2.exr", 3);
  set.mask = picture(folder / "alpha.png", 1);
  const double scale = lights.at("gradient_file_scale").get<double>() /
                       lights.at("olat_file_scale").get<double>() *
                       lights.at("sum_weight_per_light").get<double>();
  for (size_t i = 0; i < set.directions.size(); ++i) {
    char name[32];
    std::snprintf(name, sizeof(name), "olat/%03zu.exr", i);
    set.lights.push_back(picture(folder / name, 3));
    for (float& v : set.lights.back().data) v *= static_cast<float>(scale);
  }
  return set;
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  namespace fs = std::filesystem;
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 1);
  if (argc != 3) throw std::runtime_error("usage: import-olat FROM TO");
  std::vector<fs::path> folders;
  for (const auto& entry : fs::recursive_directory_iterator(argv[1]))
    if (entry.is_regular_file() && entry.path().filename() == "lights.json")
      folders.push_back(entry.path().parent_path());
  if (folders.empty()) throw std::runtime_error(std::string("no pictures of lights in ") + argv[1]);
  std::sort(folders.begin(), folders.end());
  fs::create_directories(argv[2]);
  for (const fs::path& folder : folders) {
    const auto set = inverse::bench::load(folder);
    const std::string path = std::string(argv[2]) + "/" + set.name + ".f32";
    inverse::bench::write_olat_set(path, set);
    std::printf("%s: %zu lights, %d x %d\n", path.c_str(), set.lights.size(), set.a.width,
                set.a.height);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "import-olat: %s\n", error.what());
  return 1;
}
