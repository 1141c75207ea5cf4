// SPDX-License-Identifier: LGPL-2.1-or-later
#include "guide.hpp"

#include "kernels/gpu/reduce.hpp"
#include "kernels/image/pyramid.hpp"

namespace inverse {
namespace {

constexpr uint32_t kRows = 8;  // cells that an invocation of statistics.comp adds up

gpu::Items sum_items(Extent level1) {
  return line_of(static_cast<uint64_t>(level1.width) * ((level1.height + kRows - 1) / kRows));
}

}  // namespace

Guide::Guide(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      extent1_(half_of(extent)),
      extent2_(half_of(extent1_)),
      extent4_(half_of(half_of(extent2_))),
      guide_(device),
      colored_guide_(device, {.colored = true}),
      cells_kernel_(device),
      guide_coarse_kernel_(device),
      sum_(device, {.rows = kRows}),
      frame_(device, {}, shaders::intrinsic_guide_frame::kSumLanes),
      colored_frame_(device, {.colored = true}, shaders::intrinsic_guide_frame::kSumLanes) {
  using gpu::Buffer;
  using gpu::Element;
  level0_ = Buffer::create(device, Element::vec4, extent_.pixels());
  level1_ = Buffer::create(device, Element::vec4, extent1_.pixels());
  cells_ = Buffer::create(device, Element::vec4,
                          extent2_.pixels() * shaders::intrinsic_guide_cells::CELL_STRIDE);
  guide_coarse_ = Buffer::create(device, Element::vec4, extent4_.pixels());
  statistics_ = Buffer::create(device, Element::vec4, kStatisticsSize);
  for (auto& sums : sums_)
    sums = Buffer::create(device, Element::vec4,
                          gpu::partial_count(*sum_.kernel(), sum_items(extent1_)));
}

void Guide::record(gpu::Commands& commands, const gpu::BufferPtr& frame,
                   const gpu::BufferPtr& light) {
  if (!cleared_)
    for (const auto& sums : sums_) commands.fill(sums);
  cleared_ = true;
  commands.dispatch(
      light ? colored_guide_ : guide_,
      {.frame = frame, .light = light ? light : frame, .fine = level0_, .coarse = level1_},
      {.size = extent_}, line_of(extent1_.pixels()));
  commands.dispatch(cells_kernel_, {.fine = level0_, .cells = cells_}, {.size = extent_},
                    line_of(extent2_.pixels()));
  commands.dispatch(guide_coarse_kernel_, {.cells = cells_, .guide_coarse = guide_coarse_},
                    {.size = extent2_}, line_of(extent4_.pixels()));
  commands.dispatch(sum_,
                    {.level = level1_,
                     .intensity_sums = sums_[0],
                     .chromatic_sums = sums_[1],
                     .plain_sums = sums_[2]},
                    {.size = extent1_}, sum_items(extent1_));
  commands.dispatch(light ? colored_frame_ : frame_,
                    {.intensity_sums = sums_[0],
                     .chromatic_sums = sums_[1],
                     .plain_sums = sums_[2],
                     .light = light ? light : sums_[0],
                     .statistics = statistics_},
                    {.count = static_cast<uint32_t>(sums_[0]->count())}, {});
}

}  // namespace inverse
