// SPDX-License-Identifier: LGPL-2.1-or-later
#include "strokes.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "kernels/image/pack4.hpp"
#include "kernels/image/pyramid.hpp"

namespace inverse {

Strokes::Strokes(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      extent_(extent),
      cells_(half_of(half_of(extent))),
      share_(device),
      average_(device, {}, device->variant().area_workgroup()),
      measure_(device, {}, device->variant().area_workgroup()),
      edges_(device, {}, 4, 16),
      values_(device, {}, 1, 4),
      fill_(device, extent),
      strokes_(gpu::Buffer::create(device, gpu::Element::vec4,
                                   kMaxStrokes * shaders::intrinsic_strokes_edges::STROKE_STRIDE)),
      means_(gpu::Buffer::create(device, gpu::Element::vec4, kMaxStrokes)),
      residuals_(gpu::Buffer::create(device, gpu::Element::vec4, kMaxStrokes)) {}

void Strokes::set(gpu::Commands& commands, const StrokesPtr& list) {
  forget();
  list_ = list;
  if (!list || list->strokes.empty()) return;
  StrokeMask mask = draw_strokes(*list, extent_);
  bounds_ = std::move(mask.bounds);
  count_ = static_cast<uint32_t>(bounds_.size());
  for (size_t i = 0; i < count_; ++i) unfilled_ = unfilled_ || list->strokes[i].fill;
  commands.write_table(mask_, gpu::Element::vec4, mask.pixels);
  write_strokes(commands);
  find_shares(commands);
}

void Strokes::fill(gpu::Commands& commands, const gpu::BufferPtr& reflectance) {
  if (!std::exchange(unfilled_, false)) return;
  fill_.record(commands, mask_, strokes_, count_, reflectance);
  for (size_t i = 0; i < count_; ++i)
    if (list_->strokes[i].fill && bounds_[i].right > 0)
      bounds_[i] = {0, 0, cells_.width, cells_.height};
  write_strokes(commands);
  find_shares(commands);
}

void Strokes::write_strokes(gpu::Commands& commands) {
  using Shader = shaders::intrinsic_strokes_labels;
  std::vector<std::array<float, 4>> table(size_t{count_} * Shader::STROKE_STRIDE);
  for (size_t i = 0; i < count_; ++i) {
    const Stroke& stroke = list_->strokes[i];
    table[Shader::STROKE_STRIDE * i + Shader::STROKE_BOUNDS] = {
        static_cast<float>(bounds_[i].left), static_cast<float>(bounds_[i].top),
        static_cast<float>(bounds_[i].right), static_cast<float>(bounds_[i].bottom)};
    table[Shader::STROKE_STRIDE * i + Shader::STROKE_KIND] = {
        static_cast<float>(stroke.kind == Stroke::Kind::shading ? Shader::KIND_SHADING
                                                                : Shader::KIND_REFLECTANCE),
        stroke.fill ? 1.0F : 0.0F};
  }
  commands.write_table(strokes_, gpu::Element::vec4, table);
}

void Strokes::find_shares(gpu::Commands& commands) {
  if (!cell_mask_)
    cell_mask_ = gpu::Buffer::create(device_, gpu::Element::vec4, pack4_count(cells_));
  commands.dispatch(share_, {.mask = mask_, .cell_mask = cell_mask_}, {.size = extent_},
                    line_of(pack4_count(cells_)));
}

void Strokes::record_edges(gpu::Commands& commands, const Guide& guide,
                           const gpu::BufferPtr& system, const gpu::BufferPtr& flux,
                           const TileList* listed) const {
  if (empty()) return;
  edges_.dispatch(commands, listed,
                  {.mask = mask_,
                   .strokes = strokes_,
                   .level0 = guide.level0(),
                   .system = system,
                   .flux = flux},
                  {.size = extent_}, line_of(pack4_count(extent_)));
}

void Strokes::record_values(gpu::Commands& commands, const Guide& guide,
                            const gpu::BufferPtr& value, const TileList* listed) const {
  if (empty()) return;
  commands.dispatch(average_,
                    {.cell_mask = cell_mask_,
                     .strokes = strokes_,
                     .cells = guide.cells(),
                     .value = value,
                     .means = means_},
                    {.size = cells_}, line_of(uint64_t{count_} * average_.kernel()->workgroup()));
  values_.dispatch(commands, listed,
                   {.cell_mask = cell_mask_,
                    .strokes = strokes_,
                    .means = means_,
                    .cells = guide.cells(),
                    .value = value},
                   {.size = cells_}, line_of(pack4_count(cells_)));
}

void Strokes::record_residuals(gpu::Commands& commands, const Guide& guide,
                               const gpu::BufferPtr& shading) const {
  if (empty()) return;
  commands.dispatch(measure_,
                    {.mask = mask_,
                     .strokes = strokes_,
                     .level0 = guide.level0(),
                     .shading = shading,
                     .residuals = residuals_},
                    {.size = extent_}, line_of(uint64_t{count_} * measure_.kernel()->workgroup()));
}

float Strokes::rms_of(std::span<const float, 4> residual) {
  using Shader = shaders::intrinsic_strokes_residuals;
  const float weight = residual[Shader::RESIDUAL_WEIGHT];
  if (!(weight > 0)) return 0;
  const float mean = residual[Shader::RESIDUAL_SUM] / weight;
  return std::sqrt(std::max(residual[Shader::RESIDUAL_SQUARES] / weight - mean * mean, 0.0F));
}

}  // namespace inverse
