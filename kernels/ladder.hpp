#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace inverse {

/// How much work goes into a frame: levels of a method's Ladder.
enum class Quality : uint8_t {
  low,     ///< the least work that still looks like a decomposition
  medium,  ///< the knee of the curve, and the default
  high,    ///< more work, for files
  best,    ///< near the converged solution, for reference
};

/// A level of work between cheap and good.
template <typename P>
struct Level {
  double cost;      ///< time of a frame in relation to the other levels, measured
  void (*set)(P&);  ///< the parameters that make it up
};

/// The measured front of error against time of a method (docs/report), from cheap to good, and
/// which of its levels each quality stands for.
template <typename P>
struct Ladder {
  std::vector<Level<P>> levels;
  std::array<size_t, 4> qualities;

  std::vector<double> costs() const {
    std::vector<double> costs;
    for (const auto& level : levels) costs.push_back(level.cost);
    return costs;
  }
  size_t top(Quality quality) const { return qualities[static_cast<size_t>(quality)]; }
  /// The defaults that go with a quality.
  P preset(Quality quality) const {
    P params;
    levels[top(quality)].set(params);
    return params;
  }
};

}  // namespace inverse
