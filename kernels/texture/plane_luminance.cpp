// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plane_luminance.hpp"

#include <algorithm>

namespace inverse {

PlaneLuminance::PlaneLuminance(const std::shared_ptr<gpu::Device>& device, Extent frame)
    : frame_(frame),
      factor_((std::max({frame.width, frame.height, 1U}) - 1) / kMaxSide + 1),
      size_{(frame.width + factor_ - 1) / factor_, (frame.height + factor_ - 1) / factor_},
      reduce_(device, {.factor = factor_}),
      values_(gpu::Buffer::create(device, gpu::Element::scalar, size_.pixels(),
                                  gpu::Memory::readback)) {}

void PlaneLuminance::record(gpu::Commands& commands, const Plane& frame) {
  commands.dispatch(reduce_, {.frame = frame.buffer, .luminance = values_},
                    {.frame_size = frame_, .size = size_},
                    gpu::Items(static_cast<uint32_t>(size_.pixels())));
}

std::span<const float> PlaneLuminance::values() const {
  return {values_->map_as<float>(), size_.pixels()};
}

}  // namespace inverse
