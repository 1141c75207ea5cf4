// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/material/estimate/material.hpp"

namespace inverse::testing {

/// A material whose shininess is certain, `bin`; its diffuse albedo is .5 in green, .25 in blue.
inline Material material(float red, float specular, size_t bin) {
  Material m;
  m.diffuse = {red, .5F, .25F};
  m.specular = specular;
  m.bins[bin] = 1;
  return m;
}

}  // namespace inverse::testing
