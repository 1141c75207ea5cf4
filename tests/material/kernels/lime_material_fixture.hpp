// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cmath>

#include "kernels/material/lime_material.hpp"
#include "lime_models.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/srgb.hpp"

namespace inverse::testing {

inline float decoded(float code) { return (std::exp(2 * code) - 1) / 4; }

/// A frame of gray with a red disc, some of it bluish.
class LimeTest : public GpuTest {
 protected:
  static constexpr Extent kFrame{96, 64};
  const float kRed = srgb_light(.9F), kBlue = srgb_light(.4F), kGray = srgb_light(.5F);

  Plane scene(float x, float y, float radius, float green = .4F, float blue = .4F) {
    Pixels pixels(kFrame.pixels() * 4, kGray);
    for (uint32_t row = 0; row < kFrame.height; ++row)
      for (uint32_t column = 0; column < kFrame.width; ++column)
        if (std::hypot(static_cast<float>(column) + .5F - x, static_cast<float>(row) + .5F - y) <
            radius) {
          float* pixel = &pixels[4 * (size_t{row} * kFrame.width + column)];
          pixel[0] = kRed;
          pixel[1] = srgb_light(green);
          pixel[2] = srgb_light(blue);
        }
    return plane(kFrame, pixels);
  }
  /// Two scenes' discs in one.
  Plane together(const Plane& one, const Plane& two) {
    Pixels pixels = download(one);
    const Pixels other = download(two);
    for (size_t i = 0; i < pixels.size(); ++i)
      if (other[i] != kGray) pixels[i] = other[i];
    return plane(kFrame, pixels);
  }
  LimeMaterial::Layers frame(LimeMaterial& lime, const Plane& plane, bool still = false) {
    LimeMaterial::Layers layers;
    LimeMaterial::Params drawn = params;
    drawn.layers_asked = true;
    run([&](gpu::Commands& commands) {
      lime.record(commands, plane, drawn, still);
      layers = lime.record_layers(commands, plane);
    });
    if (lime.recorded() > delay) lime.done(lime.recorded() - 1 - delay);
    return layers;
  }
  /// A frame whose layers are not read.
  LimeMaterial::Report unseen(LimeMaterial& lime, float blue, float green = .4F) {
    return unseen(lime, scene(50, 30, 20, green, blue));
  }
  LimeMaterial::Report unseen(LimeMaterial& lime, const Plane& picture) {
    run([&](gpu::Commands& commands) { lime.record(commands, picture, params, false); });
    if (lime.recorded() > delay) lime.done(lime.recorded() - 1 - delay);
    return last_report(lime);
  }
  /// In the middle of the object, as a frame shows it.
  float gloss_of(LimeMaterial& lime, float blue) {
    return download(frame(lime, scene(50, 30, 20, .5F, blue)).gloss)[4 * (30 * kFrame.width + 50)];
  }
  static LimeMaterial::Report last_report(const LimeMaterial& lime) {
    return lime.report(lime.recorded() - 1);
  }
  /// Of the light's map, all of it.
  static double blueness(const LimeMaterial& lime) {
    double blue = 0;
    const auto& rgb = lime.light()->rgb();
    for (size_t i = 2; i < rgb.size(); i += 3) blue += double{rgb[i]};
    return blue;
  }
  uint64_t delay = 0;  ///< frames that are in flight when the next one is recorded
  LimeMaterial::Params params;
};

}  // namespace inverse::testing
