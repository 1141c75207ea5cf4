// SPDX-License-Identifier: LGPL-2.1-or-later
// Bad input, one by one and mixed, as a camera, a decoder or a bug may produce it.
#pragma once
#include <string>

#include "kernels/global/global_intrinsic.hpp"
#include "kernels/intrinsic/intrinsic_decomposition.hpp"
#include "kernels/thesis/chapter3/thesis_params.hpp"
#include "kernels/thesis/chapter5/global_thesis_params.hpp"
#include "shrink.hpp"

namespace inverse::extremes {

/// Bits of Case::faults. What covers the whole frame comes first; later ones lie on top.
enum Fault : uint32_t {
  kBlack,
  kWhite,
  kOneColor,
  kFaintNoise,    ///< at 1/255
  kCheckerboard,  ///< single pixels of black and white
  kFlashing,      ///< every second frame black, the others white
  kHalfBlack,
  kStripes,   ///< of one pixel, black and the brightest
  kNegative,  ///< patches below zero
  kHotPixel,  ///< 1e4
  kHuge,      ///< 3e38 and the largest float
  kDenormal,  ///< 1e-40
  kNan,
  kInfinite,
  kMinusInfinite,
  kColorNoise,  ///< every channel by itself, up to 0.3
  kSaturated,   ///< a rectangle where one or more channels are full
  kGray,        ///< the green channel in all three
  kFaults       ///< how many
};
/// Sets of them with light of 1e4 and more beside full scale, which no format that the elements
/// take holds.
inline constexpr uint32_t kBeyondFormats = 1U << kStripes | 1U << kHotPixel | 1U << kHuge;
/// How many of them a method's random cases draw from: those that spoil color, from kColorNoise on,
/// are for methods that look for the light's.
uint32_t faults_for(Solver solver);
const char* name_of(Fault fault);

/// Bits of Case::knobs: parameters at the ends of their ranges, each drawn from the seed.
inline constexpr uint32_t kKnobs = 6;

/// Frame number `frame` of a case: a colored mosaic under a light with a border, then its faults,
/// in places drawn from the seed. Alpha is 1.
Pixels frame_of(const Case& one, uint32_t frame);

/// The parameters of a case: defaults, then its knobs.
IntrinsicDecomposition::Params intrinsic_params_of(const Case& one);
ThesisParams thesis_params_of(const Case& one);
GlobalIntrinsic::Params global_params_of(const Case& one);
GlobalThesisParams global_thesis_params_of(const Case& one);

/// What of a value the methods take: NaN, negative and −Inf 0, +Inf 1, the rest at most `most`.
float finite_light(float value, float most);

}  // namespace inverse::extremes
