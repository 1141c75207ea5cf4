// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
// The command line of the benchmarks of the thesis' method.
#include "kernels/thesis/chapter3/thesis_decomposition.hpp"
#include "tests/bench/support/command_line.hpp"

namespace inverse::bench {

/// The options that all of them have.
inline Options thesis_options(ThesisParams& params, Extent& extent, std::string& dump) {
  return {{"--dump", text(dump)},
          {"--size",
           {true,
            [&extent](const char* value) {
              return sscanf(value, "%ux%u", &extent.width, &extent.height) == 2;
            }}},
          {"--irls", integer(params.irls_iterations)},
          {"--pcg", integer(params.pcg_iterations)},
          {"--levels", integer(params.levels)},
          {"--settled", number(params.residual_tolerance)},
          {"--epsilon", number(params.epsilon)}};
}

}  // namespace inverse::bench
