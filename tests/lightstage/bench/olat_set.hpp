// SPDX-License-Identifier: LGPL-2.1-or-later
// Images of a subject under one light at a time, and under a light stage's two gradients.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tests/bench/metrics/image.hpp"

namespace inverse::bench {

/// All in one scale: a = Σ (1 + w)/2 lights[i], b = Σ (1 − w)/2 lights[i], by channel.
struct OlatSet {
  std::string name;
  std::vector<std::array<double, 3>>
      directions;  ///< of unit length: x right, y up, z to the camera
  Image a, b;
  Image mask;                 ///< one channel, 1 on the subject
  std::vector<Image> lights;  ///< as many as directions
};

/// A flat dump (flat_file.hpp) of a, b, the mask three times, then the lights, with the directions
/// after the numbers of its first line. Throws std::runtime_error for an invalid file.
void write_olat_set(const std::string& path, const OlatSet& set);
OlatSet read_olat_set(const std::string& path);

}  // namespace inverse::bench
