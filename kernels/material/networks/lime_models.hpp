// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "kernels/network/graph.hpp"

namespace inverse {

/// The five networks of thesis Fig. 6.3, exported by training/lime.
struct LimeModels {
  network::Graph segmentation;  ///< sRGB → probability of the object
  network::Graph specular;      ///< sRGB of the object and mask → code of the specular layer
  network::Graph mirror;        ///< code of the specular layer → code of the mirror image
  network::Graph albedo;        ///< sRGB and code of the specular layer → m_d, alpha
  network::Graph exponent;      ///< codes of both → probabilities of eight bins
  uint32_t side = 0;            ///< points along a side of the input square

  /// Reads segmentation.net, specular.net, mirror.net, albedo.net and exponent.net from a folder;
  /// checks that their shapes match and that the last one ends in Softmax. Throws Error(file) with
  /// the file and the fault.
  static LimeModels load(const std::string& folder);
};

}  // namespace inverse
