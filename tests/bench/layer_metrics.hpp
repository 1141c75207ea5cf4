// Errors of direct and indirect light, and of the color of light. Estimates have one free factor.
#pragma once

#include "tests/bench/image.hpp"

namespace inverse::bench {

/// A frame split into reflectance (3 channels), direct (1) and indirect light (3).
struct LightLayers {
  Image reflectance, direct, indirect;
};

/// Direct plus indirect light, 3 channels.
Image total_light(const LightLayers& layers);

/// Relative squared error of the indirect layer after the one factor that fits it best.
double indirect_error(const LightLayers& estimate, const LightLayers& truth);

/// The same, of indirect and direct layer, after the one factor that fits the total light best: the
/// amount counts.
double indirect_error_jointly(const LightLayers& estimate, const LightLayers& truth);
double direct_error_jointly(const LightLayers& estimate, const LightLayers& truth);

/// Root mean square error of the log chroma of the total light.
double tint_error(const LightLayers& estimate, const LightLayers& truth);

/// LMSE with windows of 20, one factor for all channels of a window.
double color_lmse(const Image& estimate, const Image& truth, int k = 20);

/// Mean squared error after one factor for all channels, truth scaled to a largest value of 1.
double color_mse(const Image& estimate, const Image& truth);

}  // namespace inverse::bench
