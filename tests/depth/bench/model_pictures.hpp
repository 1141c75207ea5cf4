// SPDX-License-Identifier: LGPL-2.1-or-later
// Pictures of a fused model (thesis, Fig. 4.7).
#pragma once
#include <string>
#include <vector>

#include "kernels/depth/volume.hpp"
#include "tests/bench/metrics/image.hpp"
#include "tests/lab.hpp"

namespace inverse::bench {

/// A place to look from, and the true reflectance that is seen from there.
struct Side {
  Pose pose;
  const Image& truth;
};

/// LMSE (k = 20) of a model's reflectance from each side, where it has one.
struct ModelScore {
  double reflectance = 0;  ///< mean over the sides
  double covered = 0;      ///< share of pixels that the model has
};

/// A row for each model: what it looks like from each side; the last row is the truth. Models have
/// an unknown scale: they are shown with the truth's mean. What a model lacks is black.
class ModelPictures {
 public:
  ModelPictures(const Lab& lab, const Lens& lens, std::vector<Side> sides)
      : lab_(lab), lens_(lens), sides_(std::move(sides)) {}

  ModelScore add(const VolumeData& model);
  /// A PNG of sRGB. Throws std::runtime_error.
  void write(const std::string& path) const;

 private:
  const Lab& lab_;
  Lens lens_;
  std::vector<Side> sides_;
  std::vector<Image> shown_;  // a side of a model
};

}  // namespace inverse::bench
