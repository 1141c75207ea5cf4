// SPDX-License-Identifier: LGPL-2.1-or-later
// An object in a remembered scene: the specification of the kernels of kernels/material/raster for
// RoomInsertion. World axes: x right, y down, z forward, meters.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "tests/material/reference/raster.hpp"
#include "tests/reference/camera/volume.hpp"

namespace inverse::reference {

/// What a ray of a lens meets: triangles with corners in meters, x right, y down, z forward.
struct RayHit {
  int triangle = -1;  ///< the nearest one; -1: none
  double depth = 0;   ///< along the optical axis
  Vec3 weight{};      ///< barycentric
};
/// Triangles with a corner nearer than `nearest` along the optical axis are not there.
RayHit look_through(const std::vector<Triangle>& triangles, const Vec3& ray, double nearest);

/// Light from about one direction.
struct Beam {
  Vec3 mean{};  ///< mean direction, not normalized
  double flux = 0;
  double radius = 0;   ///< at a distance of 1
  Vec3 x{}, y{}, z{};  ///< axes of its map, z the unit direction towards it
};
struct RoomObject {
  Vec3 center{};
  double radius = 1;
};
double light_on(const Beam& beam, const Vec3& normal);

constexpr int kProbeSide = 6;
/// Whether each of the lamps, the first beams, reaches place `index` of the grid around an object
/// through the scene: 6³ places from -1.1 to 1.1 radii, x first. Empty: the scene hides the place
/// from the object's center. Light from more than 1 m away is free.
using Probe = std::optional<std::array<double, 8>>;
Probe probe(const Volume& volume, const RoomObject& object, const std::vector<Beam>& beams,
            size_t lamps, int index);
/// The share of all light on a surface of the object that reaches it: probes, trilinear.
double reached_share(const std::vector<Probe>& probes, const RoomObject& object,
                     const std::vector<Beam>& beams, size_t lamps, const Vec3& place,
                     const Vec3& normal);

constexpr int kMapPixels = 64, kMapRow = 4, kMapLines = 4;
constexpr double kMapRadius = 30;  ///< pixels
/// The share of all light on a surface of the scene that an object hides. `maps`: the object from
/// each beam, 64² pixels, four in a row, four rows: height towards the beam in pixels, coverage;
/// and four rows of its other side: height away from the beam. Of each beam 16 rays, spread over
/// its disk, go in six steps from the surface to the object's top; one is stopped by the largest
/// coverage on its way. Light that the scene keeps from the surface on its way from the height of
/// the object's center does not count, nor does less than a hundredth of a beam.
double hidden_share(const Plane& maps, const RoomObject& object, const std::vector<Beam>& beams,
                    double softness, const Volume& volume, const Vec3& place, const Vec3& normal);

/// A pixel of a frame and its layers.
struct RoomPixel {
  Vec3 frame{};
  Vec4 model{}, intrinsic{};  ///< R.rgb, S
  Vec3 model_light{1, 1, 1}, light{1, 1, 1};
  std::optional<std::array<double, 2>> slope;  ///< k and ln S of white light
};
/// What R S L is.
Vec3 product(const Vec4& layers, const Vec3& light,
             const std::optional<std::array<double, 2>>& slope);
/// With an object (RGB times coverage, coverage) over it that hides a share of its light.
RoomPixel inserted(const RoomPixel& pixel, const Vec4& object, double albedo, double hidden);

}  // namespace inverse::reference
