// SPDX-License-Identifier: LGPL-2.1-or-later
#include <algorithm>

#include "peers.hpp"

namespace inverse::bench {
namespace {

constexpr float kFloor = 1e-3F;

class WithoutMemory final : public Solver {
 public:
  explicit WithoutMemory(std::function<Decomposition(const Image&)> run) : run_(std::move(run)) {}
  Decomposition run(const Image& frame, bool, Cost& cost) override {
    Decomposition d;
    cost = measure([&] { d = run_(frame); });
    return d;
  }

 private:
  std::function<Decomposition(const Image&)> run_;
};

Method trivial(const char* name, const char* description,
               std::function<Decomposition(const Image&)> run) {
  Method method{name, "trivial", description, {}, {}, {}};
  method.settings.push_back({.curve = "only",
                             .name = "",
                             .make = without_memory(std::move(run)),
                             .video = true,
                             .effort = Setting::Effort::brief});
  return method;
}

/// S from the channels of a pixel, R = I / S.
template <typename Shade>
Decomposition by_pixel(const Image& input, Shade shade) {
  Image s(input.width, input.height, 1);
  for (std::size_t i = 0; i < s.data.size(); ++i) s.data[i] = shade(&input.data[3 * i]);
  return divide(input, std::move(s));
}

}  // namespace

std::function<std::unique_ptr<Solver>(Size)> without_memory(
    std::function<Decomposition(const Image&)> run) {
  return [run = std::move(run)](Size) -> std::unique_ptr<Solver> {
    return std::make_unique<WithoutMemory>(run);
  };
}

Decomposition divide(const Image& input, Image shading) {
  constexpr float kMinShading = 1e-6F;
  Decomposition d{Image(input.width, input.height, 3), std::move(shading)};
  for (std::size_t i = 0; i < d.shading.data.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      d.reflectance.data[3 * i + c] =
          input.data[3 * i + c] / std::max(d.shading.data[i], kMinShading);
  return d;
}

Method constant_shading() {
  return trivial("constant shading", "R = I: nothing is shading", [](const Image& input) {
    return by_pixel(input, [](const float*) { return 1.0F; });
  });
}

Method constant_reflectance() {
  return trivial("constant reflectance", "R = 1: all is shading", [](const Image& input) {
    Decomposition d{Image(input.width, input.height, 3, 1.0F), {}};
    d.shading = by_pixel(input, [](const float* p) { return (p[0] + p[1] + p[2]) / 3; }).shading;
    return d;
  });
}

Method max_channel() {
  return trivial(
      "R = I / max_c I", "The largest channel is shading: no solve at all", [](const Image& input) {
        return by_pixel(input, [](const float* p) { return std::max({p[0], p[1], p[2], kFloor}); });
      });
}

}  // namespace inverse::bench
