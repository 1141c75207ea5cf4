#include "tests/bench/layer_truth.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "tests/bench/scene.hpp"

namespace inverse::bench {
namespace {

Image read(const std::string& folder, const char* layer, int index, const char* extension) {
  char name[32];
  std::snprintf(name, sizeof name, "/%s/%03d.%s", layer, index, extension);
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 1);
  const cv::Mat m = cv::imread(folder + name, cv::IMREAD_UNCHANGED);
  if (m.empty() || m.channels() < 3) throw std::runtime_error("cannot read " + folder + name);
  cv::Mat f;
  m.convertTo(f, CV_32F, m.depth() == CV_8U ? 1 / 255.0 : 1.0);
  Image out(f.cols, f.rows, 3);
  for (int y = 0; y < f.rows; ++y)
    for (int x = 0; x < f.cols; ++x)
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = f.ptr<float>(y)[x * f.channels() + 2 - c];
  return out;
}

float to_linear(float v) {
  return v <= 0.04045F ? v / 12.92F : std::pow((v + 0.055F) / 1.055F, 2.4F);
}

}  // namespace

LayerFrame load_layers(const std::string& folder, int index, int halvings, bool eight_bits) {
  LayerFrame out;
  out.truth.reflectance = read(folder, "R", index, "exr");
  const Image direct = read(folder, "Sdir", index, "exr");
  out.truth.indirect = read(folder, "Sind", index, "exr");
  out.truth.direct = Image(direct.width, direct.height, 1);
  out.input = Image(direct.width, direct.height, 3);
  constexpr std::array<float, 3> kLuminance{0.2126F, 0.7152F, 0.0722F};
  for (std::size_t i = 0; i < out.truth.direct.data.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t k = 3 * i + c;
      out.truth.direct.data[i] += kLuminance[c] * direct.data[k];
      out.input.data[k] =
          out.truth.reflectance.data[k] * (direct.data[k] + out.truth.indirect.data[k]);
    }
  if (eight_bits) {
    out.input = read(folder, "I8", index, "png");
    for (float& v : out.input.data) v = to_linear(v);
  }
  for (int k = 0; k < halvings; ++k)
    for (Image* image :
         {&out.input, &out.truth.reflectance, &out.truth.direct, &out.truth.indirect})
      *image = halve(*image);
  return out;
}

}  // namespace inverse::bench
