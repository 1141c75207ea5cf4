// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

namespace inverse {

/// A homogeneous Blinn-Phong material (thesis Eq. 6.2): the object reflects diffuse * D + specular
/// * Surface::lobe_gain(shininess) * S, with D and S as in Eq. 6.3.
struct Material {
  static constexpr size_t kBins = 8;

  std::array<float, 3> diffuse{};   ///< diffuse albedo m_d, linear RGB, 0…1
  float specular = 0;               ///< specular albedo alpha, white, 0…1
  std::array<float, kBins> bins{};  ///< probabilities of the bins of shininess, sum 1

  /// The center of a bin: bins are equally spaced in log2 from 2 to 1024.
  static float bin_middle(size_t bin) {
    return std::exp2(1 + 9 * (static_cast<float>(bin) + 0.5F) / kBins);
  }
  /// The most plausible bin: maximum expected score, 1 for the right bin and 1/5 for its neighbors.
  /// So an isolated bin loses to a nearly equally probable one among probable neighbors.
  size_t bin() const {
    const auto score = [&](size_t b) {
      return bins[b] + ((b > 0 ? bins[b - 1] : 0) + (b + 1 < kBins ? bins[b + 1] : 0)) / 5;
    };
    size_t best = 0;
    for (size_t b = 1; b < kBins; ++b)
      if (score(b) > score(best)) best = b;
    return best;
  }
  /// The exponent s: the mean of the bin centers in log2; 0 without bins. It minimizes the squared
  /// error in log s; `bin()` is more often exactly right.
  float shininess() const {
    float sum = 0, all = 0;
    for (size_t b = 0; b < kBins; ++b) {
      sum += bins[b] * std::log2(bin_middle(b));
      all += bins[b];
    }
    return all > 0 ? std::exp2(sum / all) : 0;
  }
};

}  // namespace inverse
