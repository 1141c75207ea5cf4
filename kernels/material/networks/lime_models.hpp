#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "kernels/network/graph.hpp"

namespace inverse {

/// The five networks of thesis Fig. 6.3, as training/lime exports them.
struct LimeModels {
  network::Graph segmentation;  ///< sRGB → probability of the object
  network::Graph specular;  ///< sRGB and mask, where the object is → code of the specular layer
  network::Graph mirror;    ///< code of the specular layer → code of the mirror image
  network::Graph albedo;    ///< sRGB and code of the specular layer → m_d, alpha
  network::Graph exponent;  ///< codes of both → probabilities of eight bins
  uint32_t side = 0;        ///< points along a side of the square that they see

  /// Reads segmentation.net, specular.net, mirror.net, albedo.net and exponent.net of a folder and
  /// checks that they fit each other, and that the last one ends in Softmax. Throws Error(file)
  /// naming the file and what is wrong.
  static LimeModels load(const std::string& folder);
};

}  // namespace inverse
