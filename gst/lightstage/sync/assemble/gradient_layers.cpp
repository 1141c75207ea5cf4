// SPDX-License-Identifier: LGPL-2.1-or-later
#include "gradient_layers.hpp"

#include "gst/base/meta/layers_meta.hpp"

namespace inverse {

GradientLayers::GradientLayers(const GstVideoInfo& info, const std::shared_ptr<gpu::Device>& device)
    : input_(info), planes_(device, frame_format(info).extent) {
  input_.configure(device);
  for (Slot& slot : slots_)
    slot = {std::make_unique<gpu::Commands>(device), input_.make_buffer(device),
            input_.make_buffer(device)};
}

GstBuffer* GradientLayers::make(GstBuffer* a, GstBuffer* b) {
  Slot& slot = slots_[next_++];
  slot.commands->begin();  // waits until the slot's bytes are not read any more
  const PlanePtr plane_a = planes_.acquire(), plane_b = planes_.acquire();
  input_.record(*slot.commands, a, slot.a, *plane_a);
  input_.record(*slot.commands, b, slot.b, *plane_b);
  slot.commands->submit();
  GstBuffer* pair = gst_buffer_new();
  attach_layers(pair, gradient_layers(plane_a, plane_b));
  return pair;
}

}  // namespace inverse
