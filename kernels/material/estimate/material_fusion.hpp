#pragma once
#include <cstdint>
#include <deque>

#include "material.hpp"

namespace inverse {

/// Estimates of one object's material over time (thesis 6.6): a median of the last five, which
/// takes outliers away, and of these a mean in which every frame weighs the same (Eq. 6.5 with
/// alpha = 1/t) up to a longest memory. Starts anew where the material is another.
class MaterialFusion {
 public:
  struct Params {
    /// Frames that the mean remembers: alpha is never below 1 over it.
    uint32_t memory = 100;
    /// A median whose diffuse albedo is so far (largest channel) from the mean, five times in a
    /// row, is of another object; so is one whose specular albedo is twice as far, or a
    /// sixth of log2 of the shininess three times as far.
    float other = 0.2F;
  };

  /// Takes the estimate of one frame, unless it is none: a number that is none, bins that are no
  /// probabilities.
  void add(const Material& estimate, const Params& params);
  void reset();

  /// The fused material; nothing is known of it before the first `add`.
  const Material& material() const { return mean_; }
  /// Estimates since the object came.
  uint64_t count() const { return count_; }
  /// Of these, those that the mean is of: at most Params::memory.
  uint64_t averaged() const { return averaged_; }
  /// How far single estimates are from the mean: root mean square over the last ones of the largest
  /// difference in diffuse albedo, specular albedo, and a sixth of log2 of the shininess.
  float spread() const { return spread_; }
  /// How far the mean of the last ten or so estimates is from the mean, in the same measure.
  float drift() const;
  /// Whether the mean is what estimates say, give or take `limit`: their scatter over the root of
  /// their number is below it, and they are to no side of the mean by more than that and what
  /// their scatter explains. Not before kFewest.
  bool steady(float limit) const;
  static constexpr uint64_t kFewest = 12;

 private:
  static constexpr size_t kWindow = 5;

  std::deque<Material> window_;
  Material mean_, recent_;
  uint64_t count_ = 0, averaged_ = 0;
  uint32_t others_ = 0;
  float spread_ = 0;
};

}  // namespace inverse
