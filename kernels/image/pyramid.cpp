// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pyramid.hpp"

namespace inverse {

Halve::Halve(const std::shared_ptr<gpu::Device>& device) : kernel_(device) {}

void Halve::record(gpu::Commands& commands, const Plane& fine, const Plane& coarse) const {
  commands.dispatch_rows(kernel_, {.fine = fine.buffer, .coarse = gpu::by_rows(coarse.buffer)},
                         {.fine_size = fine.extent, .size = coarse.extent, .first_row = 0},
                         {coarse.extent.width, coarse.extent.height});
}

}  // namespace inverse
