#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "kernels/image/plane.hpp"

namespace inverse {

/// Light that comes from far away, by direction: a latitude-longitude map of linear RGB radiance.
///
/// Directions are those of the camera: x right, y up, z towards the camera. Row 0 is up, the center
/// column is +z, columns to the right of it have x > 0. Radiance 1 from everywhere gives a white
/// diffuse object the value 1 (thesis Eq. 6.1-6.3 with k = 1/pi: D(n) = 1/pi ∫ (w·n) E dw).
class Environment {
 public:
  static constexpr uint32_t kMaxWidth = 16384;  ///< columns of a map at most
  static constexpr float kMaxRadiance = 1e9F;   ///< what a map may hold at most

  /// `rgb` is row by row. Throws Error(file) where the size is not 2 : 1 from 4 x 2 to
  /// 16384 x 8192, where `rgb` is not as long as that, and where it has NaN, negative or absurdly
  /// large (kMaxRadiance) values; `name` is what the text calls the map.
  Environment(Extent extent, std::vector<float> rgb, const std::string& name = "environment map");

  /// The same light from everywhere.
  static Environment uniform(std::array<float, 3> radiance);
  /// Neutral light of a photographer's studio, for where nothing is known of the real one: a large
  /// soft box up at the left, a dimmer one at the right, a bright ceiling and a darker floor. A
  /// white diffuse object has a mean of 0.5 under it, which cameras make middle gray.
  static Environment studio();
  /// Reads a Radiance file (.hdr). A panorama in a file is what somebody sees who stands in the
  /// place of the object and looks at the camera, as cameras, Blender and collections of
  /// panoramas have it: further right in it is further left for the camera, so that columns are
  /// mirrored here and in `save`. Radiance as `bounded`, `changed` too where it is wanted. Throws
  /// Error(file).
  static Environment load(const std::string& path, size_t* changed = nullptr);
  /// A map of radiance of any origin, which is made such as is allowed: what is no number or below
  /// 0 becomes 0, what is above kMaxRadiance becomes that, but infinity the largest of the others,
  /// or the largest half float where they are less; `changed` is how many values were. Throws as
  /// the constructor.
  static Environment bounded(Extent extent, std::vector<float> rgb, size_t& changed,
                             const std::string& name = "environment map");
  /// Throws Error(file) where the size is not that of a map; `name` as of the constructor.
  static void check_size(Extent extent, const std::string& name);
  /// Writes a Radiance file, with 8 bits of mantissa. An earlier file there stays where this one
  /// cannot be written whole, unless its folder takes no other. Throws Error(output).
  void save(const std::string& path) const;
  /// Throws what `save` would, as far as can be told before; nothing is written.
  static void check_target(const std::string& path);

  Extent extent() const { return extent_; }
  const std::vector<float>& rgb() const { return rgb_; }
  bool operator==(const Environment&) const = default;

  /// The direction of a place in the map, in pixels: the middle of a pixel is at a half.
  std::array<double, 3> direction(double column, double row) const;
  /// Solid angle of a pixel of this row, in steradian.
  double solid_angle(uint32_t row) const;

 private:
  Extent extent_;
  std::vector<float> rgb_;
};

/// Left and right of a map change places: from a file's point of view to the camera's, and back
/// (Environment::load). `rgb` is row by row.
void mirror_columns(std::vector<float>& rgb, Extent extent);

}  // namespace inverse
