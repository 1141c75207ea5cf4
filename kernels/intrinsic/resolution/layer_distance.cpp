// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layer_distance.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/gpu/reduce.hpp"
#include "kernels/image/pack4.hpp"

namespace inverse {
namespace {
constexpr uint32_t kRows = 8;  // pixels that an invocation of compare.comp adds up
gpu::Items strips_of(Extent extent) {
  return line_of(static_cast<uint64_t>(extent.width) * ((extent.height + kRows - 1) / kRows));
}
}  // namespace

LayerDistance::LayerDistance(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      compare_(device, {.rows = kRows}),
      total_(device),
      sums_(gpu::Buffer::create(device, gpu::Element::vec4,
                                gpu::partial_count(*compare_.kernel(), strips_of(extent)))),
      sum_(gpu::Buffer::create(device, gpu::Element::vec4, 1)) {
  for (auto& found : found_)
    found = gpu::Buffer::create(device, gpu::Element::vec4, 1, gpu::Memory::readback);
}

void LayerDistance::record(gpu::Commands& commands, const gpu::BufferPtr& frame,
                           const gpu::BufferPtr& one, const gpu::BufferPtr& other, uint64_t slot) {
  if (!cleared_) commands.fill(sums_);
  cleared_ = true;
  commands.dispatch(compare_, {.frame = frame, .one = one, .other = other, .sums = sums_},
                    {.size = extent_}, strips_of(extent_));
  commands.dispatch(total_, {.sums = sums_, .total = sum_},
                    {.count = static_cast<uint32_t>(sums_->count())}, {});
  commands.copy(sum_, found_[slot], sum_->bytes());
}

float LayerDistance::value(uint64_t slot) const {
  const float* sum = found_[slot]->map_as<float>();
  if (!(sum[0] > 0)) return 0;
  const float mean = sum[1] / sum[0];
  return std::sqrt(std::max(sum[2] / sum[0] - mean * mean, 0.0F));
}

}  // namespace inverse
