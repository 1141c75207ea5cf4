// SPDX-License-Identifier: LGPL-2.1-or-later
#include "guided_upsample.hpp"

#include "kernels/image/pack4.hpp"
#include "kernels/image/pyramid.hpp"

namespace inverse {

GuidedUpsample::GuidedUpsample(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      sample_(device),
      fit_(device),
      layers_(device),
      colored_layers_(device, {.colored = true}),
      samples_(gpu::Buffer::create_by_rows(device, gpu::Element::vec4, half_of(extent).pixels())),
      lines_(gpu::Buffer::create_by_rows(device, gpu::Element::vec4, half_of(extent).pixels())) {}

void GuidedUpsample::record(gpu::Commands& commands, const gpu::BufferPtr& frame,
                            const gpu::BufferPtr& half_intrinsic, const PlanePtr& slope,
                            const gpu::BufferPtr& intrinsic) const {
  const Extent half = half_of(extent_);
  const gpu::Rows rows{half.width, half.height, 1, true};
  commands.dispatch_rows(
      sample_, {.frame = frame, .intrinsic = half_intrinsic, .samples = gpu::by_rows(samples_)},
      {.frame_size = extent_, .size = half, .first_row = 0}, rows);
  commands.dispatch_rows(fit_, {.samples = samples_, .lines = gpu::by_rows(lines_)},
                         {.size = half, .first_row = 0}, rows);
  commands.dispatch_rows(slope ? colored_layers_ : layers_,
                         {.frame = frame,
                          .lines = lines_,
                          .intrinsic = gpu::by_rows(intrinsic),
                          .slope = slope ? slope->buffer : lines_},
                         {.size = extent_, .first_row = 0}, {half.width, extent_.height, 2, true});
}

}  // namespace inverse
