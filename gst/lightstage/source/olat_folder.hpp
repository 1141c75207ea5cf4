// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "gst/exr/exr_picture.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/lightstage/program/light_program.hpp"

namespace inverse {

/// A folder of images under one light at a time: lights.json with the lights' "directions" (unit
/// vectors from the subject to the light: x right, y up, z to the camera), and olat/NNN.exr, linear
/// RGB; or with "lights", objects with a "direction" and a "file", as lightstagesync writes it.
/// All calls throw Error(file) if something is missing or wrong.
class OlatFolder {
 public:
  static constexpr uint32_t kMaxPixels = 16384;  ///< along a side
  /// Reads the directions, and the size from the first image.
  explicit OlatFolder(const std::string& path);

  const std::string& path() const { return path_; }
  const std::vector<Direction>& directions() const { return directions_; }
  Extent extent() const { return extent_; }
  /// LightList::captured.
  bool captured() const { return captured_; }
  /// Lights that the list has no file for: their frames were lost.
  std::vector<uint32_t> missing() const;
  /// Reads an image: width × height RGB; black if it is missing.
  std::vector<float> image(uint32_t light) const;

 private:
  ExrPicture open(uint32_t light) const;
  std::string path_;
  std::vector<Direction> directions_;
  std::vector<std::string> files_;
  Extent extent_;
  bool captured_ = false;
};

}  // namespace inverse
