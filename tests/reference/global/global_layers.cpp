// SPDX-License-Identifier: LGPL-2.1-or-later
#include "global_layers.hpp"

#include <algorithm>

namespace inverse::reference {
namespace {

using namespace global;

constexpr double kTiny = 1e-6;

Vec3 base_color(const Chroma& chroma) {
  Vec3 b = color_of(chroma);
  const double largest = *std::max_element(b.begin(), b.end());
  for (double& v : b) v /= largest;
  return b;
}

/// What the layers add up to.
Vec3 sum_of(const std::vector<Vec3>& base, const std::vector<double>& amount) {
  Vec3 sum{};
  for (std::size_t k = 0; k < base.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c) sum[c] += base[k][c] * amount[k];
  return sum;
}

}  // namespace

IndirectLayers split_indirect(const GlobalResult& frame, int width, int height, int steps) {
  const std::size_t n = frame.direct.size(), slots = frame.colors.color.size();
  IndirectLayers out{std::vector<Vec3>(slots, Vec3{}),
                     std::vector<std::vector<double>>(slots, std::vector<double>(n, 0.0)),
                     std::vector<double>(3 * n)};
  for (std::size_t k = 0; k < slots; ++k)
    if (frame.colors.color[k]) out.base[k] = base_color(*frame.colors.color[k]);
  std::vector<double> amount(slots);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x);
      const Vec3 light{frame.indirect[3 * i], frame.indirect[3 * i + 1], frame.indirect[3 * i + 2]};
      for (std::size_t k = 0; k < slots; ++k)
        amount[k] = frame.colors.color[k]
                        ? dot(out.base[k], frame.gather.received_from(int(k), frame.label[i], x, y,
                                                                      frame.gather_factor)) /
                              dot(out.base[k], out.base[k])
                        : 0.0;
      const double scale = mean(light) / std::max(mean(sum_of(out.base, amount)), kTiny);
      for (double& t : amount) t *= scale;
      for (int step = 0; step < steps; ++step) {
        const Vec3 sum = sum_of(out.base, amount);
        for (std::size_t k = 0; k < slots; ++k)
          amount[k] *= dot(out.base[k], light) / std::max(dot(out.base[k], sum), kTiny);
      }
      const Vec3 sum = sum_of(out.base, amount);
      for (std::size_t k = 0; k < slots; ++k) out.amount[k][i] = amount[k];
      for (std::size_t c = 0; c < 3; ++c) out.remainder[3 * i + c] = light[c] - sum[c];
    }
  return out;
}

Recolored recolor(const GlobalResult& frame, const IndirectLayers& layers, std::size_t k,
                  const Vec3& color) {
  Recolored out{frame.reflectance, frame.indirect};
  for (std::size_t i = 0; i < frame.direct.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      if (frame.label[i] == int(k))
        out.reflectance[3 * i + c] *= color[c] / std::max(layers.base[k][c], kTiny);
      out.indirect[3 * i + c] += (color[c] - layers.base[k][c]) * layers.amount[k][i];
    }
  return out;
}

}  // namespace inverse::reference
