// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace inverse {

/// How much work goes into a frame. Every method says by its quality levels which of its parameters
/// that sets.
enum class Quality : uint8_t { low, medium, high, best };

/// A level of work between cheap and good.
template <typename Params>
struct Level {
  double cost;                       ///< time of a frame in relation to the other levels, measured
  std::function<void(Params&)> set;  ///< the parameters that make it up
};

/// Levels of work of a method from cheap to good, measured (docs/report), and which of them each
/// quality stands for. Not all lie on the front of error against time: by LMSE of single soft
/// frames alone some are beaten by cheaper ones that flicker more or blur shadows.
template <typename Params>
struct QualityLevels {
  std::vector<Level<Params>> levels;
  std::array<size_t, 4> qualities;

  std::vector<double> costs() const {
    std::vector<double> costs;
    for (const auto& level : levels) costs.push_back(level.cost);
    return costs;
  }
  size_t top(Quality quality) const { return qualities[static_cast<size_t>(quality)]; }
  /// Sets the parameters that go with a quality.
  void set(Params& params, Quality quality) const { levels[top(quality)].set(params); }
};

}  // namespace inverse
