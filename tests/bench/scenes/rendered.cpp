// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rendered.hpp"

#include <algorithm>
#include <thread>

#include "tools/clip/denoise.hpp"

namespace inverse::bench {

TruthFrame rendered(const clip::Scene& scene, int width, int height, clip::Quality quality) {
  constexpr int kDenoisePasses = 4;
  const int threads = std::max(1, int(std::thread::hardware_concurrency()));
  clip::Layers layers = clip::render(scene, width, height, quality, threads);
  clip::denoise(layers, kDenoisePasses, threads);
  TruthFrame frame{Image(width, height, 3),
                   Image(width, height, 3),
                   Image(width, height, 1),
                   {},
                   Image(width, height, 3),
                   Image(width, height, 3),
                   {}};
  for (std::size_t i = 0; i < layers.reflectance.size(); ++i) {
    const clip::Vec3 r = layers.reflectance[i], s = layers.lamp[i] + layers.indirect[i];
    constexpr float kLuminance[] = {0.2126F, 0.7152F, 0.0722F};
    for (int c = 0; c < 3; ++c) {
      const float light = s[c] + layers.window[i];
      frame.reflectance.data[3 * i + std::size_t(c)] = r[c];
      frame.direct.data[3 * i + std::size_t(c)] = layers.lamp[i][c] + layers.window[i];
      frame.indirect.data[3 * i + std::size_t(c)] = layers.indirect[i][c];
      frame.input.data[3 * i + std::size_t(c)] = r[c] * light;
      frame.shading.data[i] += kLuminance[c] * light;
    }
  }
  frame.input = through_8_bits(frame.input);
  return frame;
}

}  // namespace inverse::bench
