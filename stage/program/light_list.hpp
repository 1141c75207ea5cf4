#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "light_program.hpp"

namespace inverse {

/// The lights of a stage as the lights.json of an OLAT folder lists them.
struct LightList {
  std::vector<Direction> directions;  ///< unit vectors
  std::vector<std::string> files;     ///< the picture under each light alone; empty: there is none
  /// Pictures are as a camera took them of a stage, so that all lights together are as bright as
  /// that camera would see them.
  bool captured = false;
  static constexpr const char* kCapture = "gst-inverse olat set";  ///< "format" of such lists

  /// Lists of three numbers under "directions", or objects with a "direction" under "lights", whose
  /// "file" is left out where there is no picture. Throws Error(file), saying what is missing or
  /// wrong; `name` is what it calls the text.
  static LightList parse(std::string_view json, const std::string& name);
  static LightList load(const std::string& path);
};

}  // namespace inverse
