// SPDX-License-Identifier: LGPL-2.1-or-later
// Random cases that fail shrink to a small reproducer.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "problem.hpp"

namespace inverse::extremes {

/// One random case, fully determined by its numbers. `faults` and `knobs` are sets of bits
/// (inputs.hpp), each of which makes the case harder.
struct Case {
  Solver solver = Solver::multigrid;
  uint32_t width = 1, height = 1, frames = 1;
  uint32_t seed = 1;
  uint32_t faults = 0, knobs = 0;

  bool operator==(const Case&) const = default;
  /// "pcg 17x5 frames=2 seed=3 faults=0x12 knobs=0x1", as parsed by `parse_case`.
  std::string text() const;
};

/// Throws std::invalid_argument.
Case parse_case(const std::string& text);

/// A random case of at most `largest` pixels a side, needles among them.
Case random_case(Solver solver, uint32_t seed, uint32_t largest);

/// Description of a case's failure, or empty.
using Check = std::function<std::optional<std::string>(const Case&)>;

/// The smallest case found that still fails, and why: from a failing one, as long as one of these
/// still fails: fewer frames, a smaller frame (half a side, a pixel less), a fault or a knob less,
/// seed 1. At most `most` runs of the check.
struct Shrunk {
  Case smallest;
  std::string reason;
  int runs = 0;
};
Shrunk shrink(const Case& failing, const std::string& reason, const Check& check, int most = 200);

/// Runs the check on `count` random cases from seed `first`; the text of the shrunk first failure,
/// or nothing.
std::optional<std::string> first_failure(Solver solver, uint32_t first, uint32_t count,
                                         uint32_t largest, const Check& check);

}  // namespace inverse::extremes
