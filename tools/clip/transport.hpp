// SPDX-License-Identifier: LGPL-2.1-or-later
// Light transport between diffuse surfaces, split into the layers of an intrinsic decomposition.
#pragma once

#include <cstdint>
#include <vector>

#include "still_life.hpp"

namespace inverse::clip {

struct Quality {
  int samples = 25;      ///< camera rays per pixel, each with one shadow ray to the lamp; a square
  int soft_samples = 8;  ///< of these, how many also see the window and the other surfaces
  int bounces = 3;       ///< diffuse bounces after the first surface
};

/// Per-pixel layers, row-major; image = reflectance · (lamp + window + indirect) by definition.
/// Where a pixel mixes surfaces, the lamp's shading is Σ R S / Σ R over its samples and channel,
/// which keeps antialiased edges exact; the soft shadings are those of the surface at the center.
struct Layers {
  int width = 0, height = 0;
  std::vector<Vec3> reflectance;  ///< linear RGB, 0…1, box-filtered over the pixel
  std::vector<Vec3> lamp;         ///< direct shading by the lamp, irradiance / π
  std::vector<float> window;      ///< direct shading by the window, irradiance / π
  std::vector<Vec3> indirect;     ///< shading by light from other surfaces, irradiance / π
  std::vector<float> variance;    ///< of the luminance of window + indirect
  std::vector<Vec3> normal;       ///< world, at the pixel's center
  std::vector<Vec3> position;     ///< world, at the pixel's center
  std::vector<uint8_t> mixed;     ///< 1 if the samples meet more than one surface
};

/// Renders `scene` with `threads` threads. The sample pattern depends on the pixel alone, so that
/// what does not change between frames carries the same residual noise.
Layers render(const Scene& scene, int width, int height, const Quality& quality, int threads);

}  // namespace inverse::clip
