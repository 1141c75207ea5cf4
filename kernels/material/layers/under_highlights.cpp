// SPDX-License-Identifier: LGPL-2.1-or-later
#include "under_highlights.hpp"

namespace inverse {

UnderHighlights::UnderHighlights(const std::shared_ptr<gpu::Device>& device, uint32_t side)
    : points_(device), pull_(device), push_(device) {
  const auto make = [&device](uint32_t points) {
    return gpu::Buffer::create(device, gpu::Element::vec4, points);
  };
  for (;; side = (side + 1) / 2) {
    const gpu::BufferPtr known = make(side * side);
    // A single point has no neighbors.
    levels_.push_back({side, known, side > 1 ? make(side * side) : known});
    if (side == 1) break;
  }
}

void UnderHighlights::record(gpu::Commands& commands, const gpu::BufferPtr& masked,
                             const gpu::BufferPtr& codes) {
  const auto points = [](const Level& level) { return gpu::Items{level.side * level.side}; };
  const auto side = [](const Level& level) { return static_cast<int32_t>(level.side); };
  const Level& first = levels_.front();
  commands.dispatch(points_, {.masked = masked, .codes = codes, .result = first.known},
                    {.count = side(first) * side(first)}, points(first));
  for (size_t n = 1; n < levels_.size(); ++n)
    commands.dispatch(pull_, {.fine = levels_[n - 1].known, .coarse = levels_[n].known},
                      {.side = side(levels_[n - 1])}, points(levels_[n]));
  for (size_t n = levels_.size() - 1; n-- > 0;)
    commands.dispatch(
        push_,
        {.fine = levels_[n].known, .coarse = levels_[n + 1].whole, .whole = levels_[n].whole},
        {.side = side(levels_[n])}, points(levels_[n]));
}

}  // namespace inverse
