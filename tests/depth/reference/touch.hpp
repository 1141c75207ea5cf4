// SPDX-License-Identifier: LGPL-2.1-or-later
// Specification of kernels/depth/touch: what of a frame is in front of a scene, and where it
// touches that.
#pragma once
#include <cstdint>
#include <vector>

#include "tests/reference/camera/volume.hpp"

namespace inverse::reference {

/// What a pixel is, compared with the view from the same place.
struct TouchKind {
  bool front = false;  ///< in front of the scene
  bool maybe = false;  ///< a little in front, or the scene is unknown there
  bool skin = false;
  bool operator==(const TouchKind&) const = default;
};

/// `depth`: of the frame, and of the view; 0: unknown. `layers`: rgb: reflectance. In front is what
/// is nearer than all that the view has in the 3 x 3 pixels around it, by more than 2 cm and 4
/// standard deviations of the sensor; a little, by more than 4 mm and one.
std::vector<TouchKind> compare(int width, int height, const std::vector<double>& depth,
                               const std::vector<double>& view, const Plane& layers);

/// What may be in front, is, if something that is lies within two pixels along each side and 2 cm
/// of depth.
std::vector<TouchKind> grow(int width, int height, const std::vector<double>& depth,
                            const std::vector<TouchKind>& kinds);

/// The touch of a frame. Skin in front has the weight (1 - d / 2.2 cm)², d its distance to the
/// nearest place of the view, of 9 x 9 within about that, if it lies outside of the surface there:
/// more than d / 2 along its normal. Of 3 x 3 tiles of 8 x 8 pixels, those
/// with most weight count; the one in the middle is one of arm_tiles.
struct TouchFound {
  Vec3 place{};     ///< mean of the nearest places, in the world
  double area = 0;  ///< m², weighted; 0: nothing is touched
  Vec3 color{};     ///< mean of ln R there
  bool colored = false;
  double distance = 0;  ///< mean of d
  double pixels = 0;    ///< with a weight
  double front = 0;     ///< share of the pixels with a depth
};
/// `normals`: of the view, toward the camera in its axes. `reflectance`: of the view, ln R and
/// confidence.
TouchFound touch(const Camera& camera, const std::vector<double>& depth,
                 const std::vector<double>& view, const Plane& normals, const Plane& reflectance,
                 const std::vector<TouchKind>& kinds);

/// Of tiles of 8 × 8 pixels, row by row: whether tiles with at least four pixels in front connect
/// it, or one around it, with the border of the picture.
std::vector<bool> arm_tiles(int width, int height, const std::vector<TouchKind>& kinds);

/// Depth without that of what is in front, and of two pixels around, in those tiles.
std::vector<double> background(int width, int height, const std::vector<double>& depth,
                               const std::vector<TouchKind>& kinds);

}  // namespace inverse::reference
