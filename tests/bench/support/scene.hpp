// What methods are measured on: stills and videos with ground truth, one flat dump each, so that
// they can be carried to a machine that has no image libraries.
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
  /// Shading by light that comes straight from its source, and by light from other surfaces: 3
  /// channels, linear, of one scale. Empty where they are not known.
  Image direct, indirect;
  Image id;  ///< 1 channel, the number of the object that is seen; empty where it is not known
};

struct Scene {
  std::string set;     ///< where it comes from: "own", "mit", …
  std::string name;    ///< unique within the set
  std::string regime;  ///< what makes it hard: "diverse value", …
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

/// The number of the frame that is shown k-th (from 0) of `count` frames that are played to and fro
/// without repeating the first or the last: 0 1 2 1 0 1 … of three.
std::size_t to_and_fro(std::size_t k, std::size_t count);

/// Halves the size by 2 x 2 means; an odd last row or column is dropped. A mask stays 1 where all
/// four are.
Image halve(const Image& image, bool is_mask = false);

/// Rec.709 luminance of a + b, which have 3 channels: 1 channel.
Image luminance_of_sum(const Image& a, const Image& b);

/// Frames as a camera or a file would deliver them: through 8-bit sRGB and back.
Image through_8_bits(const Image& linear);

/// Under a camera's shot and read noise: normal, of standard deviation .01 sqrt(v + .002) at the
/// linear value v; what falls below 0 is 0.
Image with_noise(const Image& linear, std::mt19937& random);

}  // namespace inverse::bench
