#pragma once
#include <cstdint>

namespace inverse {

/// How much work goes into a frame. Every method says which of its parameters that sets (`preset`),
/// at points of its measured work-precision curve (docs/report).
enum class Quality : uint8_t {
  low,     ///< the least work that still looks like a decomposition
  medium,  ///< the knee of the curve, and the default
  high,    ///< more work, for files
  best,    ///< near the converged solution, for reference
};

}  // namespace inverse
