// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "light_cells.hpp"

namespace inverse {

/// Selects few lights that light a subject as all lights of a stage do, from the responses of some
/// pixels. Orthogonal matching pursuit: adds the light that explains most of the remainder, then
/// fits all selected weights again, per color channel, with fixed signs. Fits half of the samples
/// and measures the error on the other half.
class LightReduction {
 public:
  explicit LightReduction(std::vector<Direction> lights) : lights_(std::move(lights)) {}

  /// Responses of samples to lights of weight 1: RGB and one more number, sample by sample, light
  /// by light. Ignores black samples and values that are not finite.
  void set_responses(std::span<const float> responses);
  /// Whether there are enough samples.
  bool ready() const { return fitted_ >= kMinSamples && tested_ >= kMinSamples; }
  void clear() { fitted_ = tested_ = 0; }

  struct Choice {
    std::vector<WeightedLight> lights;
    std::vector<uint32_t> indices;  ///< selected lights of the stage
    double error = 0;               ///< expected error
    bool all = false;               ///< true: these are all lights that are on
  };
  /// The smallest set of lights whose expected error is at most `max_error`, in place of all lights
  /// with these weights, which may be negative. The error is the mean absolute difference, relative
  /// to the mean under all lights with weights `whole`; `weights` are the part of these that is not
  /// measured. Returns all lights that are on, with error 0, if too many would be needed or there
  /// are no samples.
  Choice choose(std::span<const Rgb> weights, std::span<const Rgb> whole, double max_error) const;
  /// The error of a choice on newer samples.
  double error(const Choice& choice, std::span<const Rgb> weights,
               std::span<const Rgb> whole) const;

  static constexpr size_t kMinSamples = 16;  ///< samples of each half

 private:
  size_t samples() const { return fitted_ + tested_; }
  const float* response(size_t light, size_t channel) const {
    return &responses_[(3 * light + channel) * samples()];
  }
  std::vector<float> sum(std::span<const Rgb> weights) const;
  Choice all(std::span<const Rgb> weights) const;

  std::vector<Direction> lights_;
  size_t fitted_ = 0, tested_ = 0;
  std::vector<float> responses_;  // light by light, channel by channel: those that are fitted first
};

}  // namespace inverse
