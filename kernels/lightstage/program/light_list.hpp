// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "light_program.hpp"

namespace inverse {

/// The lights of a stage, as listed in lights.json of an OLAT folder.
struct LightList {
  std::vector<Direction> directions;  ///< unit vectors
  std::vector<std::string> files;     ///< image under each light alone; empty: no image
  /// True if a camera captured the images on a stage: their sum is then the image under all lights
  /// at that camera's exposure.
  bool captured = false;
  static constexpr const char* kCapture = "gst-inverse olat set";  ///< "format" of such lists

  /// Reads "directions", a list of triples, or "lights", a list of objects with a "direction" and
  /// an optional "file". Throws Error(file) with what is missing or wrong; messages call the text
  /// `name`.
  static LightList parse(std::string_view json, const std::string& name);
  static LightList load(const std::string& path);
};

}  // namespace inverse
