// SPDX-License-Identifier: LGPL-2.1-or-later
// Ground-truth sets for scoring decompositions, by regime.
//
// Rendered sequences enter as their 8-bit sRGB frames (what a camera or a file would deliver),
// turned to linear light; true reflectance is the renderer's, true shading the Rec.709 luminance of
// direct plus indirect irradiance. MIT objects enter as 16-bit linear images, black outside the
// object.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/support/scene.hpp"

namespace inverse::bench {

/// The difficulty of a scene. Every figure is reported per regime.
enum class Regime { kMit, kHardShadow, kNearConstantValue, kDiverseValue };
inline constexpr int kRegimes = 4;

/// "MIT objects", "hard shadow", "near-constant value", "diverse value".
const char* regime_title(Regime regime);

/// The regime of a rendered sequence by its directory's name; of unknown ones near-constant value.
Regime regime_of(const std::string& scene);

/// How many frames a rendered sequence has.
int count_frames(const std::string& directory);

/// A frame, its truth and its origin.
struct LabeledFrame : TruthFrame {
  std::string scene;  ///< Directory name; frames of one scene are held out together when tuning.
  int index = 0;      ///< Frame number inside a sequence, 0 for stills.
  Regime regime = Regime::kMit;
};

/// Loads one MIT object directory.
LabeledFrame load_mit(const std::string& directory);

/// Loads frame `index` of a rendered sequence directory.
LabeledFrame load_rendered(const std::string& directory, int index, Regime regime);

/// Every MIT object and, of each rendered sequence, `frames_per_scene` frames spread evenly (all of
/// them when 0). `root` holds one directory per set. Throws std::runtime_error naming a missing
/// file.
std::vector<LabeledFrame> load_all(const std::string& root, int frames_per_scene);

/// Halves the size by 2 x 2 means (masks: all four inside; no ids, which have no mean); an odd last
/// row or column is dropped.
LabeledFrame half_size(const LabeledFrame& frame);

}  // namespace inverse::bench
