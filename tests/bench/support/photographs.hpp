// SPDX-License-Identifier: LGPL-2.1-or-later
// Photographs without ground truth: pairs of points whose reflectance people compared.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "method.hpp"
#include "tests/bench/metrics/metrics.hpp"

namespace inverse::bench {

struct Photograph {
  std::string name;  ///< its file's
  Image input;       ///< 3 channels, linear
  std::vector<Judgment> pairs;
};

/// The photographs of a folder, by name. `pairs.json` there is
/// {"FILE.png": [{"x1": …, "y1": …, "x2": …, "y2": …, "darker": "1", "2" or "E" (equal)}, …], …}.
/// Points must be one pixel or more from the border. Throws std::runtime_error.
std::vector<Photograph> read_photographs(const std::string& folder);

/// Reflectance as an element outputs it in 16 bits: cut to 0…1.
Image as_element_output(const Image& reflectance);

/// Reflectance at the pair's first point over that at its second: means of 3 x 3 pixels and of
/// channels, at least 1e-5.
double reflectance_ratio(const Image& reflectance, const Judgment& pair);

/// The larger CIELAB chroma C*ab of the pair's two points, means of 3 x 3 pixels.
double pair_chroma(const Image& input, const Judgment& pair);

/// Runs each method at its settings for photographs; returns JSON: "pictures" with the judgments
/// and chroma of their pairs, "rows" with the ratios of a setting on a picture, and "failures".
std::string measure_photographs(const std::string& folder, const std::vector<Method>& methods,
                                const std::set<std::string>& only);

}  // namespace inverse::bench
