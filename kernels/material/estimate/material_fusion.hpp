// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <deque>

#include "material.hpp"

namespace inverse {

/// Fuses the estimates of one object's material over time (thesis 6.6): a median of the last five
/// against outliers, then the mean of Eq. 6.5 (alpha = 1/t) up to a maximum memory. Restarts when
/// the material changes.
class MaterialFusion {
 public:
  struct Params {
    /// Maximum number of frames in the mean: alpha is at least 1 / memory.
    uint32_t memory = 100;
    /// The mean restarts after five consecutive medians whose diffuse albedo differs from it by
    /// more than this (largest channel), specular albedo by twice as much, or a sixth of log2 of
    /// the shininess by three times as much.
    float new_object_distance = 0.2F;
  };

  /// Adds the estimate of one frame; ignores it if values are not finite or bins are no
  /// probabilities.
  void add(const Material& estimate, const Params& params);
  void reset();

  /// The fused material; default before the first `add`.
  const Material& material() const { return mean_; }
  /// Number of estimates since the object appeared.
  uint64_t count() const { return count_; }
  /// Number of estimates in the mean: at most Params::memory.
  uint64_t averaged() const { return averaged_; }
  /// Scatter of single estimates about the mean: rms over recent ones of the largest difference in
  /// diffuse albedo, specular albedo, and a sixth of log2 of the shininess.
  float spread() const { return spread_; }
  /// Distance of the running mean of about ten estimates from the mean, in the same measure.
  float drift() const;
  /// Whether the mean has converged to within `limit`: its standard error is below `limit`, and the
  /// running mean deviates by no more than that plus its expected scatter. False before
  /// kMinEstimates.
  bool converged(float limit) const;
  static constexpr uint64_t kMinEstimates = 12;

 private:
  static constexpr size_t kWindow = 5;

  std::deque<Material> window_;
  Material mean_, recent_;
  uint64_t count_ = 0, averaged_ = 0;
  uint32_t others_ = 0;
  float spread_ = 0;
};

}  // namespace inverse
