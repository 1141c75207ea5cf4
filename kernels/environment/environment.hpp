// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "kernels/image/plane.hpp"

namespace inverse {

class OpenFile;

/// Distant light by direction: a latitude-longitude map of linear RGB radiance.
///
/// Directions are in camera axes: x right, y up, z towards the camera. Row 0 is up, the center
/// column is +z, columns to the right of it have x > 0. Uniform radiance 1 gives a white diffuse
/// object the value 1 (thesis Eq. 6.1-6.3 with k = 1/pi: D(n) = 1/pi ∫ (w·n) E dw).
class Environment {
 public:
  static constexpr uint32_t kMaxWidth = 16384;  ///< maximum number of columns
  static constexpr float kMaxRadiance = 1e9F;   ///< maximum value of a map

  /// `rgb` is row by row. Throws Error(file) if the size is not 2 : 1 from 4 x 2 to 16384 x 8192,
  /// if `rgb` has another length, or if it has values that are NaN, negative or above kMaxRadiance.
  /// Messages call the map `name`.
  Environment(Extent extent, std::vector<float> rgb, const std::string& name = "environment map");

  /// Uniform light from all directions.
  static Environment uniform(std::array<float, 3> radiance);
  /// Neutral light of a photographer's studio, used while the real light is unknown: a large soft
  /// box at the upper left, a dimmer one at the right, a bright ceiling and a darker floor. A white
  /// diffuse object has a mean of 0.5 under it, which cameras map to middle gray.
  static Environment studio();
  /// Reads a Radiance file (.hdr). Cameras, Blender and panorama collections store the view of an
  /// observer at the object who faces the camera: right in the file is left for the camera. So
  /// columns are mirrored here and in `save`. Invalid radiance is changed as in `bounded`;
  /// `changed` receives the count. Throws Error(file).
  static Environment load(const std::string& path, size_t* changed = nullptr);
  /// The same of a file that is open; messages call it `path`.
  static Environment load(const OpenFile& file, const std::string& path, size_t* changed = nullptr);
  /// Makes a map from any radiance: NaN and negative values become 0; values above kMaxRadiance
  /// become kMaxRadiance; infinity becomes the largest finite value, or the largest half float if
  /// that is greater. `changed` receives the number of changed values. Throws as the constructor.
  static Environment bounded(Extent extent, std::vector<float> rgb, size_t& changed,
                             const std::string& name = "environment map");
  /// Throws Error(file) if the size is not that of a map; `name` as in the constructor.
  static void check_size(Extent extent, const std::string& name);
  /// Writes a Radiance file with 8 bits of mantissa. If writing fails, an earlier file is kept,
  /// unless its folder accepts no second file. Throws Error(output).
  void save(const std::string& path) const;
  /// Throws the errors of `save` that can be found without writing.
  static void check_target(const std::string& path);

  Extent extent() const { return extent_; }
  const std::vector<float>& rgb() const { return rgb_; }
  bool operator==(const Environment&) const = default;

  /// The direction of a position in the map, in pixels; pixel centers are at halves.
  std::array<double, 3> direction(double column, double row) const;
  /// Solid angle of a pixel of this row, in steradian.
  double solid_angle(uint32_t row) const;

 private:
  Extent extent_;
  std::vector<float> rgb_;
};

/// Mirrors a map left to right, between the view in files and the camera's (Environment::load).
/// `rgb` is row by row.
void mirror_columns(std::vector<float>& rgb, Extent extent);

}  // namespace inverse
