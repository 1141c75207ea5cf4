// SPDX-License-Identifier: LGPL-2.1-or-later
#include "method.hpp"

namespace inverse {

std::vector<Choice> QualityText::choices() const {
  return {{static_cast<int>(Quality::low), "low", values[0]},
          {static_cast<int>(Quality::medium), "medium", values[1]},
          {static_cast<int>(Quality::high), "high", values[2]},
          {static_cast<int>(Quality::best), "best", values[3]}};
}

}  // namespace inverse
