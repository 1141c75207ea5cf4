// What a decomposition method has to beat. None of them sees a mask.
#pragma once

#include "tests/bench/image.hpp"

namespace inverse::bench {

struct Decomposition {
  Image reflectance;  ///< 3 channels, linear.
  Image shading;      ///< 1 channel, linear.
};

/// R = I, S = 1.
Decomposition constant_shading(const Image& input);

/// R = 1 (gray), S = mean channel of I.
Decomposition constant_reflectance(const Image& input);

/// R = I / max_c I, S = max_c I: no solve at all; exact where every albedo has the same value.
Decomposition max_channel(const Image& input);

/// Retinex (Land & McCann; Horn) as a Poisson problem over ln I: an edge keeps its log-intensity
/// step in shading unless it is classified as a reflectance edge.
struct RetinexParams {
  bool color = true;
  double intensity_threshold = 0.5;  ///< |step of mean log| above this is reflectance (gray: 0.1).
  double chroma_threshold = 0.1;     ///< |step of log chromaticity| above this is reflectance.
};
Decomposition retinex(const Image& input, const RetinexParams& params);

}  // namespace inverse::bench
