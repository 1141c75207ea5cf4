// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace inverse {

/// Decides for which frames a network runs whose output changes slowly with its input. Not
/// thread-safe.
class NetworkRate {
 public:
  /// Mean change of the input from which on a frame is a cut, and below which it is still.
  static constexpr float kCut = 0.1F, kStill = 0.01F;
  /// How many times as many frames one run serves while the picture is still, if `interval` > 1.
  static constexpr uint32_t kStillFactor = 8;

  /// Whether the network is to run for an input: at once after `reset`, at a cut, and every
  /// `interval` frames; never for the input that it ran for last. NaN counts as a cut.
  bool due(std::span<const float> input, uint32_t interval);
  /// How many frames ago the network ran.
  uint32_t age() const { return age_; }
  /// How often it ran.
  uint32_t runs() const { return runs_; }
  void reset() { input_.clear(), age_ = 0; }

 private:
  std::vector<float> input_;  // that it ran for last
  uint32_t age_ = 0, runs_ = 0;
};

}  // namespace inverse
