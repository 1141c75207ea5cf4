// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stroke_fill.hpp"

#include "kernels/image/pack4.hpp"
#include "stroke.hpp"

namespace inverse {

StrokeFill::StrokeFill(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      average_(device, {}, device->variant().area_workgroup()),
      label_(device),
      claim_(device),
      fill_(device),
      components_(device, extent) {}

void StrokeFill::record(gpu::Commands& commands, const gpu::BufferPtr& mask,
                        const gpu::BufferPtr& strokes, uint32_t count,
                        const gpu::BufferPtr& reflectance) {
  if (!labels_) {
    const auto& device = commands.device();
    colors_ = gpu::Buffer::create(device, gpu::Element::vec4, kMaxStrokes);
    labels_ = gpu::Buffer::create(device, gpu::Element::vec4, extent_.pixels());
    claims_ = gpu::Buffer::create(device, gpu::Element::word, extent_.pixels());
  }
  const gpu::Items pixels{extent_.width, extent_.height};
  commands.dispatch(
      average_, {.mask = mask, .strokes = strokes, .reflectance = reflectance, .colors = colors_},
      {.size = extent_}, line_of(uint64_t{count} * average_.kernel()->workgroup()));
  commands.dispatch(label_,
                    {.mask = mask,
                     .strokes = strokes,
                     .colors = colors_,
                     .reflectance = reflectance,
                     .labels = labels_,
                     .claims = claims_},
                    {.size = extent_, .count = static_cast<int32_t>(count)}, pixels);
  components_.record(commands, labels_);
  commands.dispatch(
      claim_, {.mask = mask, .labels = labels_, .roots = components_.roots(), .claims = claims_},
      {.size = extent_}, pixels);
  commands.dispatch(
      fill_, {.labels = labels_, .roots = components_.roots(), .claims = claims_, .mask = mask},
      {.size = extent_}, line_of(pack4_count(extent_)));
}

}  // namespace inverse
