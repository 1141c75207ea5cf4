#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "light_cells.hpp"

namespace inverse {

/// Finds few lights that light a subject as all lights of a stage do, from what each of them gives
/// some pixels of it: lights are taken one by one, each time the one that explains most of what is
/// still missing, and the brightness of all that were taken is fitted anew (orthogonal matching
/// pursuit, each color channel by itself; weights keep the sign that they were taken with). Half of
/// the samples are fitted to, on the other half the error is measured.
class LightReduction {
 public:
  explicit LightReduction(std::vector<Direction> lights) : lights_(std::move(lights)) {}

  /// What lights of weight 1 give samples: RGB and one more number, sample by sample, light by
  /// light. Black samples, and what is no number, are left out.
  void set_responses(std::span<const float> responses);
  /// Whether there are samples enough to choose by.
  bool ready() const { return fitted_ >= kFewest && tested_ >= kFewest; }
  void clear() { fitted_ = tested_ = 0; }

  struct Choice {
    std::vector<WeightedLight> lights;
    std::vector<uint32_t> indices;  ///< of these, in the stage
    double error = 0;               ///< that is expected
    bool all = false;               ///< whether these are all that are lit
  };
  /// The fewest lights that stay within `max_error` when they stand for all lights with these
  /// weights, which may be negative: the mean absolute difference, over the mean under all lights
  /// with the weights `whole`, of which `weights` are what is not known otherwise. All lights that
  /// are lit, with error 0, where too many of them would be needed or where there are no samples.
  Choice choose(std::span<const Rgb> weights, std::span<const Rgb> whole, double max_error) const;
  /// The error of a choice for samples that came since.
  double error(const Choice& choice, std::span<const Rgb> weights,
               std::span<const Rgb> whole) const;

  static constexpr size_t kFewest = 16;  ///< samples of each half

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
