// SPDX-License-Identifier: LGPL-2.1-or-later
#include "strokes.hpp"

#include <cmath>

#include "kernels/image/pack4.hpp"
#include "kernels/image/pyramid.hpp"

namespace inverse {

Strokes::Strokes(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      cells_(half_of(half_of(extent))),
      share_(device),
      average_(device, {}, device->variant().area_workgroup()),
      measure_(device, {}, device->variant().area_workgroup()),
      edges_(device, {}, 4, 16),
      values_(device),
      mask_(device, extent),
      means_(gpu::Buffer::create(device, gpu::Element::vec4, kMaxStrokes)),
      residuals_(gpu::Buffer::create(device, gpu::Element::vec4, kMaxStrokes)) {}

void Strokes::set(gpu::Commands& commands, const StrokesPtr& list,
                  const StrokeMask::Places& places) {
  followed_ = false;
  mask_.set(commands, list, places);
  find_shares(commands);
}

void Strokes::fill(gpu::Commands& commands, const StrokeMask::Reflectance& of,
                   const SeenStrokes* seen) {
  followed_ = false;
  mask_.fill(commands, of, seen);
  find_shares(commands);
}

void Strokes::follow(gpu::Commands& commands, const StrokeMask::Reflectance& of,
                     const SeenStrokes* seen) {
  followed_ = true;
  mask_.follow(commands, of, seen);
  using Moved = shaders::image_strokes_commit;
  commands.when(mask_.moved(), sizeof(uint32_t) * Moved::MOVED_STROKES,
                [&] { find_shares(commands); });
}

void Strokes::find_shares(gpu::Commands& commands) {
  if (empty()) return;
  if (!cell_mask_)
    cell_mask_ = gpu::Buffer::create(commands.device(), gpu::Element::vec4, pack4_count(cells_));
  commands.dispatch(share_, {.mask = mask_.pixels(), .cell_mask = cell_mask_}, {.size = extent_},
                    line_of(pack4_count(cells_)));
}

void Strokes::record_edges(gpu::Commands& commands, const Guide& guide,
                           const gpu::BufferPtr& system, const gpu::BufferPtr& flux,
                           const TileList* listed) const {
  if (empty()) return;
  edges_.dispatch(commands, listed,
                  {.mask = mask_.pixels(),
                   .strokes = mask_.strokes(),
                   .level0 = guide.level0(),
                   .system = system,
                   .flux = flux},
                  {.size = extent_}, line_of(pack4_count(extent_)));
}

void Strokes::record_values(gpu::Commands& commands, const Guide& guide,
                            const gpu::BufferPtr& value) const {
  if (empty()) return;
  commands.dispatch(average_,
                    {.cell_mask = cell_mask_,
                     .strokes = mask_.strokes(),
                     .cells = guide.cells(),
                     .value = value,
                     .means = means_},
                    {.size = cells_}, line_of(uint64_t{count()} * average_.kernel()->workgroup()));
  commands.dispatch(values_,
                    {.cell_mask = cell_mask_,
                     .strokes = mask_.strokes(),
                     .means = means_,
                     .cells = guide.cells(),
                     .value = value},
                    {.size = cells_}, line_of(pack4_count(cells_)));
}

void Strokes::record_residuals(gpu::Commands& commands, const Guide& guide,
                               const gpu::BufferPtr& shading) const {
  if (empty()) return;
  commands.dispatch(measure_,
                    {.mask = mask_.pixels(),
                     .strokes = mask_.strokes(),
                     .level0 = guide.level0(),
                     .shading = shading,
                     .residuals = residuals_},
                    {.size = extent_}, line_of(uint64_t{count()} * measure_.kernel()->workgroup()));
}

float Strokes::rms_of(std::span<const float, 4> residual) {
  using Shader = shaders::intrinsic_strokes_residuals;
  const float weight = residual[Shader::RESIDUAL_WEIGHT];
  if (!(weight > 0)) return 0;
  const float mean = residual[Shader::RESIDUAL_SUM] / weight;
  return std::sqrt(std::max(residual[Shader::RESIDUAL_SQUARES] / weight - mean * mean, 0.0F));
}

}  // namespace inverse
