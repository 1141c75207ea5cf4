// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <random>
#include <vector>

#include "tests/kernels/gpu_fixture.hpp"

namespace inverse::testing {

/// Replaces one number in `every` by one that breaks careless arithmetic.
inline Pixels with_extremes(Pixels pixels, unsigned seed, unsigned every = 7) {
  using Limits = std::numeric_limits<float>;
  constexpr float kExtremes[] = {0,
                                 -0.F,
                                 1e-30F,
                                 Limits::denorm_min(),
                                 -1,
                                 1e30F,
                                 Limits::max(),
                                 kInf,
                                 -Limits::max(),
                                 65504,
                                 1,
                                 -kInf,
                                 1e-6F,
                                 Limits::min(),
                                 1e8F,
                                 kNan,
                                 255,
                                 -1e-30F,
                                 -kNan,
                                 1e-3F};
  std::mt19937 random(seed);
  for (float& p : pixels)
    if (random() % every == 0) p = kExtremes[random() % std::size(kExtremes)];
  return pixels;
}

/// Random layers; `hostile`: with extremes.
inline Pixels any_pixels(Extent extent, unsigned seed, bool hostile) {
  Pixels pixels = random_pixels(extent, seed, 0, 1.5F);
  return hostile ? with_extremes(std::move(pixels), seed + 1) : pixels;
}

/// Random layers with shading over 24 stops and extremes.
inline Pixels layers_over_24_stops(Extent extent, unsigned seed) {
  Pixels pixels = random_pixels(extent, seed);
  for (size_t i = 3; i < pixels.size(); i += 4) pixels[i] = std::exp2(24 * pixels[i] - 14);
  return with_extremes(std::move(pixels), seed, 20);
}

inline std::vector<reference::Vec4> reference_of(const Pixels& pixels) {
  std::vector<reference::Vec4> result;
  for (size_t n = 0; n < pixels.size() / 4; ++n) result.push_back(pixel_of(pixels, n));
  return result;
}

/// Tolerance is relative where numbers exceed 1.
inline void expect_pixels(const Pixels& got, const std::function<reference::Vec4(size_t)>& expected,
                          double tolerance, const char* what) {
  for (size_t n = 0; n < got.size() / 4; ++n) {
    const reference::Vec4 wanted = expected(n);
    for (size_t c = 0; c < 4; ++c) {
      ASSERT_TRUE(std::isfinite(got[4 * n + c])) << what << " at " << n << " channel " << c;
      ASSERT_NEAR(got[4 * n + c], wanted[c], tolerance * (1 + std::abs(wanted[c])))
          << what << " at " << n << " channel " << c;
    }
  }
}

class EditorTest : public GpuTest {
 protected:
  /// Unedited layers of a random frame.
  Layers layers(Extent extent, const Pixels& intrinsic) {
    return intrinsic_layers(shared_plane(extent, random_pixels(extent, 91)),
                            shared_plane(extent, intrinsic), nullptr);
  }
};

}  // namespace inverse::testing
