// SPDX-License-Identifier: LGPL-2.1-or-later
#include "denoise.hpp"

#include <thread>
#include <utility>

namespace inverse::clip {
namespace {

constexpr float kKernel[3] = {3.0f / 8, 1.0f / 4, 1.0f / 16};  // B3 spline
constexpr float kNormalPower = 48;
constexpr float kPlaneDistance = 0.006f;   // meters off the tangent plane
constexpr float kLuminanceDeviations = 3;  // standard deviations within which values count as
                                           // similar

struct Soft {
  std::vector<Vec3> indirect;
  std::vector<float> window, variance;
  float value(size_t pixel) const { return window[pixel] + luminance(indirect[pixel]); }
};

/// Gaussian-weighted variance of the 3 × 3 neighborhood: single estimates are too noisy to guide.
float local_variance(const Soft& soft, int width, int height, int x, int y) {
  float sum = 0, weights = 0;
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      int u = std::clamp(x + i, 0, width - 1), v = std::clamp(y + j, 0, height - 1);
      float weight = static_cast<float>((2 - std::abs(i)) * (2 - std::abs(j)));
      sum += weight * soft.variance[static_cast<size_t>(v) * width + u];
      weights += weight;
    }
  }
  return sum / weights;
}

void filter_rows(const Layers& layers, const Soft& in, Soft& out, int step, int begin, int end) {
  int width = layers.width, height = layers.height;
  for (int y = begin; y < end; ++y) {
    for (int x = 0; x < width; ++x) {
      size_t p = static_cast<size_t>(y) * width + x;
      Vec3 normal = layers.normal[p], position = layers.position[p];
      float value = in.value(p);
      float spread =
          kLuminanceDeviations * std::sqrt(local_variance(in, width, height, x, y)) + 1e-4f;
      Vec3 indirect;
      float window = 0, variance = 0, weights = 0;
      for (int j = -2; j <= 2; ++j) {
        int v = y + j * step;
        if (v < 0 || v >= height) continue;
        for (int i = -2; i <= 2; ++i) {
          int u = x + i * step;
          if (u < 0 || u >= width) continue;
          size_t q = static_cast<size_t>(v) * width + u;
          float alike = std::pow(std::max(dot(normal, layers.normal[q]), 0.0f), kNormalPower);
          float off_plane = std::fabs(dot(normal, layers.position[q] - position));
          float difference = std::fabs(value - in.value(q));
          float weight = kKernel[std::abs(i)] * kKernel[std::abs(j)] * alike *
                         std::exp(-off_plane / kPlaneDistance - difference / spread);
          if (q == p) weight = kKernel[0] * kKernel[0];
          window += in.window[q] * weight;
          indirect += in.indirect[q] * weight;
          variance += in.variance[q] * weight * weight;
          weights += weight;
        }
      }
      out.window[p] = window / weights;
      out.indirect[p] = indirect / weights;
      out.variance[p] = variance / (weights * weights);
    }
  }
}

/// Antialiases the soft layers where surfaces meet, by a tent over the neighborhood.
void smooth_mixed_pixels(const Layers& layers, const Soft& in, Soft& out) {
  int width = layers.width, height = layers.height;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      size_t p = static_cast<size_t>(y) * width + x;
      if (!layers.mixed[p]) continue;
      Vec3 indirect;
      float window = 0;
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
          int u = std::clamp(x + i, 0, width - 1), v = std::clamp(y + j, 0, height - 1);
          size_t q = static_cast<size_t>(v) * width + u;
          float weight = static_cast<float>((2 - std::abs(i)) * (2 - std::abs(j))) / 16;
          window += in.window[q] * weight;
          indirect += in.indirect[q] * weight;
        }
      }
      out.window[p] = window;
      out.indirect[p] = indirect;
    }
  }
}

}  // namespace

void denoise(Layers& layers, int passes, int threads) {
  Soft in{layers.indirect, layers.window, layers.variance};
  Soft out = in;
  for (int pass = 0; pass < passes; ++pass) {
    {
      std::vector<std::jthread> pool;
      for (int i = 0; i < threads; ++i) {
        int begin = layers.height * i / threads, end = layers.height * (i + 1) / threads;
        pool.emplace_back([&, begin, end] { filter_rows(layers, in, out, 1 << pass, begin, end); });
      }
    }
    std::swap(in, out);
  }
  out = in;
  smooth_mixed_pixels(layers, in, out);
  layers.window = std::move(out.window);
  layers.indirect = std::move(out.indirect);
}

}  // namespace inverse::clip
