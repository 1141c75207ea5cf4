// SPDX-License-Identifier: LGPL-2.1-or-later
// OpenCV's edge-aware filters as decomposers: ln reflectance is ln of the mean channel, smoothed
// where chromaticity is constant; shading is the remainder. The guide is the chromaticity I / sum
// of I, which shadows do not change; l0 smoothing has no guide and smooths the image itself.
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/ximgproc.hpp>

#include "peers.hpp"

namespace inverse::bench {
namespace {

constexpr float kFloor = 1e-3F;

/// ln of the mean channel.
cv::Mat log_mean(const Image& input) {
  cv::Mat m(input.height, input.width, CV_32F);
  for (std::size_t i = 0; i < input.data.size() / 3; ++i) {
    const float* p = &input.data[3 * i];
    m.ptr<float>()[i] = std::log(std::max((p[0] + p[1] + p[2]) / 3, kFloor));
  }
  return m;
}

/// Chromaticity in 8 bits; 255 is a third more than the largest share of a channel in white.
cv::Mat chromaticity(const Image& input) {
  cv::Mat guide(input.height, input.width, CV_8UC3);
  for (std::size_t i = 0; i < input.data.size() / 3; ++i) {
    const float* p = &input.data[3 * i];
    const float sum = p[0] + p[1] + p[2] + 3 * kFloor;
    for (int c = 0; c < 3; ++c)
      guide.ptr<uchar>()[3 * i + std::size_t(c)] =
          cv::saturate_cast<uchar>(255 * (p[c] + kFloor) / sum);
  }
  return guide;
}

/// Reflectance has the smoothed mean channel and the frame's chroma.
Decomposition from_smoothed(const Image& input, const cv::Mat& m, const cv::Mat& smooth) {
  Image shading(input.width, input.height, 1);
  for (std::size_t i = 0; i < shading.data.size(); ++i)
    shading.data[i] = std::exp(m.ptr<float>()[i] - smooth.ptr<float>()[i]);
  return divide(input, std::move(shading));
}

template <typename Filter>
Method filtered(const char* name, const char* description, const char* strength,
                std::initializer_list<std::pair<const char*, double>> settings, const char* usual,
                Filter filter) {
  Method method{name, "peer", description, {}, {}, {}};
  for (const auto& [label, value] : settings)
    method.settings.push_back(
        {.curve = strength,
         .name = label,
         .order = value,
         .parameters = {{strength, text_of(value)}},
         .make = without_memory([filter, value = value](const Image& input) {
           const cv::Mat m = log_mean(input);
           cv::Mat smooth;
           filter(chromaticity(input), m, smooth, value);
           return from_smoothed(input, m, smooth);
         }),
         .effort = std::string(usual) == label ? Setting::Effort::brief : Setting::Effort::usual});
  return method;
}

}  // namespace

Method fast_global_smoother() {
  return filtered("fast global smoother", "OpenCV ximgproc (Min et al. 2014)", "lambda",
                  {{"100", 100}, {"1e3", 1e3}, {"1e4", 1e4}}, "1e3",
                  [](const cv::Mat& guide, const cv::Mat& m, cv::Mat& out, double lambda) {
                    constexpr double kSigmaColor = 4;
                    cv::ximgproc::fastGlobalSmootherFilter(guide, m, out, lambda, kSigmaColor);
                  });
}

Method domain_transform() {
  return filtered("domain transform", "OpenCV ximgproc (Gastal and Oliveira 2011)", "sigma",
                  {{"20", 20}, {"60", 60}, {"200", 200}}, "60",
                  [](const cv::Mat& guide, const cv::Mat& m, cv::Mat& out, double sigma) {
                    constexpr double kSigmaColor = 20;
                    cv::ximgproc::dtFilter(guide, m, out, sigma, kSigmaColor, cv::ximgproc::DTF_RF);
                  });
}

Method guided_filter() {
  return filtered("guided filter", "OpenCV ximgproc (He et al. 2010)", "radius",
                  {{"8", 8}, {"24", 24}, {"60", 60}}, "24",
                  [](const cv::Mat& guide, const cv::Mat& m, cv::Mat& out, double radius) {
                    constexpr double kEpsilon = 16;
                    cv::ximgproc::guidedFilter(guide, m, out, int(radius), kEpsilon);
                  });
}

Method l0_smoothing() {
  Method method{"l0 smoothing", "peer", "OpenCV ximgproc (Xu et al. 2011)", {}, {}, {}};
  for (const auto& [label, lambda] : {std::pair{".01", 0.01}, {".03", 0.03}, {".1", 0.1}})
    method.settings.push_back(
        {.curve = "lambda",
         .name = label,
         .order = lambda,
         .parameters = {{"lambda", label}},
         .make = without_memory([lambda = lambda](const Image& input) {
           cv::Mat image(input.height, input.width, CV_32FC3), flat;
           std::transform(input.data.begin(), input.data.end(), image.ptr<float>(),
                          [](float v) { return std::sqrt(std::clamp(v, 0.0F, 1.0F)); });
           cv::ximgproc::l0Smooth(image, flat, lambda, 2.0);
           const cv::Mat m = log_mean(input);
           Image flattened(input.width, input.height, 3);
           std::transform(flat.ptr<float>(), flat.ptr<float>() + flattened.data.size(),
                          flattened.data.begin(), [](float v) { return v * v; });
           return from_smoothed(input, m, log_mean(flattened));
         }),
         .effort = lambda == 0.03   ? Setting::Effort::brief
                   : lambda == 0.01 ? Setting::Effort::usual
                                    : Setting::Effort::full});
  return method;
}

}  // namespace inverse::bench
