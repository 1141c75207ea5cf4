// SPDX-License-Identifier: LGPL-2.1-or-later
// Scenes for measurements: stills and videos with ground truth, one flat dump each, usable on
// machines without image libraries.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "tests/bench/metrics/image.hpp"

namespace inverse::bench {

/// A frame and its truth. Reflectance and shading have scales of their own.
struct TruthFrame {
  Image input;        ///< 3 channels, linear, [0, 1]
  Image reflectance;  ///< 3 channels, linear
  Image shading;      ///< 1 channel, linear
  Image mask;         ///< 1 channel, 0 or 1; empty when every pixel counts; for scoring only
  /// Shading by direct light, and by light from other surfaces: 3 channels, linear, in one scale.
  /// Empty if unknown.
  Image direct, indirect;
  Image id;  ///< 1 channel, number of the visible object; empty if unknown
};

struct Scene {
  std::string set;     ///< origin: "own", "mit", …
  std::string name;    ///< unique within the set
  std::string regime;  ///< its difficulty: "diverse value", …
  bool video = false;  ///< frames follow each other; else each stands alone
  std::vector<TruthFrame> frames;
};

/// The words after the numbers of the dump's first line are set=…, scene=…, regime=… and video=0|1
/// with _ for blanks; the channels are I.rgb, R.rgb, S, mask and, where they are known, direct.rgb,
/// indirect.rgb, id (-1 where only that is unknown). Throws std::runtime_error.
Scene read_scene(const std::string& path);
void write_scene(const std::string& folder, const Scene& scene);

/// Every dump in a folder, by name.
std::vector<Scene> read_scenes(const std::string& folder);

/// Index of the k-th frame (from 0) of `count` frames played forwards and backwards without
/// repeating the ends: 0 1 2 1 0 1 … of three.
std::size_t to_and_fro(std::size_t k, std::size_t count);

/// Halves the size by 2 x 2 means; an odd last row or column is dropped. A mask stays 1 if all
/// four are.
Image halve(const Image& image, bool is_mask = false);

/// Rec.709 luminance of a + b, which have 3 channels: 1 channel.
Image luminance_of_sum(const Image& a, const Image& b);

/// Frames quantized as from a camera or a file: through 8-bit sRGB and back.
Image through_8_bits(const Image& linear);

/// Adds a camera's shot and read noise: normal, standard deviation .01 sqrt(v + .002) at the linear
/// value v; negative results become 0.
Image with_noise(const Image& linear, std::mt19937& random);

}  // namespace inverse::bench
