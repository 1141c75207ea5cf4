// SPDX-License-Identifier: LGPL-2.1-or-later
// Baselines for direct and indirect light: estimates of indirect light without a solve, subtracted
// from the shading of intrinsicdecomp.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernels/intrinsic/scaled_intrinsic.hpp"
#include "methods.hpp"

namespace inverse::bench {
namespace {

/// Share of indirect light in a closed room; a constant baseline.
constexpr float kShare = 0.35F;

float mean(const Image& image) {
  return std::accumulate(image.data.begin(), image.data.end(), 0.0F) / float(image.data.size());
}

/// Blurs along one axis; pixels outside the frame are ignored.
Image blurred_along(const Image& image, float sigma, bool down) {
  const int reach = int(std::ceil(3 * sigma));
  Image out(image.width, image.height, image.channels);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      float weights = 0;
      for (int d = -reach; d <= reach; ++d) {
        const int u = down ? x : x + d, v = down ? y + d : y;
        if (u < 0 || v < 0 || u >= image.width || v >= image.height) continue;
        const float weight = std::exp(-float(d * d) / (2 * sigma * sigma));
        weights += weight;
        for (int c = 0; c < image.channels; ++c) out.at(x, y, c) += weight * image.at(u, v, c);
      }
      for (int c = 0; c < image.channels; ++c) out.at(x, y, c) /= weights;
    }
  return out;
}

/// The frame, blurred by a Gaussian of .3 of its width, computed on a small copy.
Image blurred(const Image& frame) {
  Image small = frame;
  while (small.width >= 80 && small.height >= 2) small = halve(small);
  const float sigma = 0.3F * float(small.width);
  small = blurred_along(blurred_along(small, sigma, false), sigma, true);
  Image out(frame.width, frame.height, frame.channels);
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x)
      for (int c = 0; c < frame.channels; ++c)
        out.at(x, y, c) = small.at(std::min(x * small.width / frame.width, small.width - 1),
                                   std::min(y * small.height / frame.height, small.height - 1), c);
  return out;
}

class Guess final : public Solver {
 public:
  Guess(DeviceSession& session, Size size, bool blur)
      : session_(session),
        blur_(blur),
        method_(session.device(), {uint32_t(size.width), uint32_t(size.height)}) {}

  Decomposition run(const Image& frame, bool continues, Cost& cost) override {
    Decomposition d = session_.run(
        frame,
        [&](gpu::Commands& commands, const PlanePtr& input) {
          return method_.record(commands, input, {}, {!continues});
        },
        cost);
    const Cost guess = measure([&] { split(frame, d); });
    cost.wall += guess.wall;
    cost.processor += guess.processor;
    return d;
  }

 private:
  /// Where the estimated indirect light exceeds the shading, it is clamped and direct light is 0.
  void split(const Image& frame, Decomposition& d) const {
    Image guess = blur_ ? blurred(frame) : Image(frame.width, frame.height, 3, 1.0F);
    const float scale = kShare * mean(d.shading) / std::max(mean(guess), 1e-6F);
    d.direct = d.indirect = Image(frame.width, frame.height, 3);
    for (std::size_t i = 0; i < d.shading.data.size(); ++i) {
      float* e = &guess.data[3 * i];
      const float shading = d.shading.data[i], bounced = scale * (e[0] + e[1] + e[2]) / 3;
      const float part = std::min(1.0F, shading / std::max(bounced, 1e-6F));
      for (std::size_t c = 0; c < 3; ++c) {
        d.direct.data[3 * i + c] = std::max(0.0F, shading - part * bounced);
        d.indirect.data[3 * i + c] = part * scale * e[c];
        d.reflectance.data[3 * i + c] =
            frame.data[3 * i + c] /
            std::max(d.direct.data[3 * i + c] + d.indirect.data[3 * i + c], 1e-6F);
      }
    }
    d.shading = luminance_of_sum(d.direct, d.indirect);
  }

  DeviceSession& session_;
  bool blur_;
  ScaledIntrinsic method_;
};

}  // namespace

Method indirect_guesses(DeviceSession& session) {
  Method method{
      "guessed indirect light",
      "trivial",
      "A fixed share of the shading of intrinsicdecomp is indirect: gray, or of the blurred "
      "frame's color",
      {},
      {},
      {}};
  for (const bool blur : {false, true})
    method.settings.push_back({.curve = "guess",
                               .name = blur ? "blurred frame" : "constant gray",
                               .order = double(blur),
                               .make = [&session, blur](Size size) -> std::unique_ptr<Solver> {
                                 return std::make_unique<Guess>(session, size, blur);
                               },
                               .video = true,
                               .layers_only = true,
                               .effort = Setting::Effort::brief});
  return method;
}

}  // namespace inverse::bench
