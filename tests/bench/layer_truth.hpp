// Rendered sequences with the truth about direct and indirect light.
#pragma once

#include <string>

#include "tests/bench/layer_metrics.hpp"

namespace inverse::bench {

struct LayerFrame {
  Image input;  ///< Linear RGB.
  LightLayers truth;
};

/// Frame `index` of a sequence's folder (R, Sdir, Sind as EXR; I8), halved `halvings` times. The
/// input is the product of the layers, or with `eight_bits` the 8-bit file turned to linear light.
/// Direct light is the luminance of Sdir, which is colored only where materials mix in a pixel.
/// Throws std::runtime_error naming a missing file.
LayerFrame load_layers(const std::string& folder, int index, int halvings, bool eight_bits);

/// Writes a PNG: input, reflectance, total, direct and indirect light of the estimate, and below
/// them the truth's; light is halved. Throws std::runtime_error where it cannot.
void write_picture(const std::string& path, const LayerFrame& frame, const LightLayers& estimate);

}  // namespace inverse::bench
