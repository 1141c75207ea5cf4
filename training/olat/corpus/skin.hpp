// SPDX-License-Identifier: LGPL-2.1-or-later
// What surfaces are made of, and where on a head.
#pragma once

#include <cstdint>

#include "random.hpp"
#include "vec.hpp"

namespace inverse::olat {

using lime::kPi;
using lime::Random;
using lime::Vec;

/// Places on a head at rest, in cm: x to its left as seen by us right, y up, z out of the face.
struct Landmarks {
  Vec mouth{0, -3.4f, 11};
  float mouth_width = 2.6f, mouth_height = 0.9f;
  Vec brow{3.2f, 5.6f, 10};  ///< middle of the brow at positive x; the other is its mirror image
  float brow_width = 2.2f, brow_height = 0.45f;
  Vec cheek{5, -1, 9};
  float hairline_front = 9, front = 11;  ///< height of the hairline at this z …
  float hairline_back = -4, back = -3;   ///< … and at this one; straight between them
  float chin = -8, jaw_back = 2;         ///< beard: below the mouth, in front of jaw_back
};

enum class Part : std::uint32_t { skin, eye, hair, cloth, teeth, mouth };

/// How light leaves a point of a surface: diffuse, and a dielectric's specular in two GGX lobes.
struct Material {
  Part part = Part::skin;
  Vec albedo{0.5f, 0.5f, 0.5f};
  float f0 = 0.04f;                    ///< reflectance at normal incidence
  float rough = 0.4f, rough2 = 0.25f;  ///< GGX alpha of the two lobes
  float second = 0;                    ///< share of the second lobe
};

/// Colors of one person, as functions of a place at rest.
class Skin {
 public:
  Skin(Random& random, const Landmarks& marks);
  Material skin(Vec rest) const;
  Material hair(std::uint32_t strand, bool brow) const;
  Material cloth(Vec rest) const;
  /// `axis`: out of the eye through the pupil; `direction`: from its center to the point; unit.
  Material eye(Vec axis, Vec direction, float spin) const;
  Material teeth() const;
  Material mouth() const;

  float scatter() const { return scatter_; }  ///< multiplies the radii of subsurface scattering

 private:
  Landmarks marks_;
  std::uint32_t salt_;
  Vec base_, blotch_, lips_, freckle_, hair_, cloth_, cloth2_, iris_;
  float blotch_size_, freckles_, freckle_size_, blush_, stubble_, lip_strength_;
  float f0_, rough_, second_, rough2_, rough_noise_, oily_;
  float eye_rough_, eye_f0_, iris_size_, cloth_stripes_, scatter_, paint_;
};

/// Smooth noise in space, about 0 … 1 around 0.5; one octave has cells of size 1.
float noise(Vec p, std::uint32_t salt, int octaves = 1);
/// A number in [0, 1) of three whole numbers.
float hash(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t salt);

}  // namespace inverse::olat
