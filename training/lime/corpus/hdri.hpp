// SPDX-License-Identifier: LGPL-2.1-or-later
// Environment maps from a folder of Radiance files, with those that are kept for tests.
#pragma once

#include <string>
#include <vector>

#include "environment.hpp"

namespace inverse::lime {

/// Maps of Poly Haven (CC0) that only the test split sees: two interiors, a studio, a street and a
/// garden.
constexpr const char* kHeldOutMaps[] = {"vestibule", "aerodynamics_workshop", "studio_small_03",
                                        "leadenhall_market", "chinese_garden"};

struct NamedMap {
  std::string name;  ///< File name without folder and ending.
  bool held_out;
  Environment map;  ///< 96 × 192, mean luminance 1.
};

/// All *.hdr files of a folder, sorted by name; throws std::runtime_error that says which file
/// cannot be read.
std::vector<NamedMap> load_maps(const std::string& folder);

}  // namespace inverse::lime
