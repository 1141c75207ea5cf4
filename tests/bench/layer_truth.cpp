#include "tests/bench/layer_truth.hpp"

#include <algorithm>
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

float to_code(float v) {
  v = std::min(std::max(v, 0.0F), 1.0F);
  return v <= 0.0031308F ? 12.92F * v : 1.055F * std::pow(v, 1 / 2.4F) - 0.055F;
}

/// An image of 1 or 3 channels into the tile (column, row) of a picture.
void paint(cv::Mat& picture, int column, int row, const Image& image, float scale) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      auto& pixel = picture.at<cv::Vec3b>(row * image.height + y, column * image.width + x);
      for (int c = 0; c < 3; ++c)
        pixel[2 - c] = static_cast<unsigned char>(
            255 * to_code(scale * image.at(x, y, image.channels == 3 ? c : 0)) + 0.5F);
    }
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

void write_picture(const std::string& path, const LayerFrame& frame, const LightLayers& estimate) {
  const Image& input = frame.input;
  cv::Mat picture(2 * input.height, 5 * input.width, CV_8UC3);
  for (int row = 0; row < 2; ++row) {
    const LightLayers& layers = row == 0 ? estimate : frame.truth;
    paint(picture, 0, row, input, 1);
    paint(picture, 1, row, layers.reflectance, 1);
    paint(picture, 2, row, total_light(layers), 0.5F);
    paint(picture, 3, row, layers.direct, 0.5F);
    paint(picture, 4, row, layers.indirect, 0.5F);
  }
  if (!cv::imwrite(path, picture)) throw std::runtime_error("cannot write " + path);
}

}  // namespace inverse::bench
