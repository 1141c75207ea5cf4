#include "guide.hpp"

#include <array>

#include "kernels/gpu/reduce.hpp"
#include "kernels/gpu/shaders.hpp"
#include "kernels/image/pyramid.hpp"

INVERSE_SHADER(intrinsic_guide_guide);
INVERSE_SHADER(intrinsic_guide_cells);
INVERSE_SHADER(intrinsic_guide_wide);
INVERSE_SHADER(intrinsic_guide_statistics);
INVERSE_SHADER(intrinsic_guide_frame);

namespace inverse {
namespace {

constexpr uint32_t kRows = 8;       // cells that an invocation of statistics.comp adds up
constexpr uint32_t kSumLanes = 64;  // of frame.comp
constexpr uint64_t kCellStride = 2;

gpu::Items sum_items(Extent level1) {
  return line_of(static_cast<uint64_t>(level1.width) * ((level1.height + kRows - 1) / kRows));
}

}  // namespace

Guide::Guide(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      extent1_(half_of(extent)),
      extent2_(half_of(extent1_)),
      extent4_(half_of(half_of(extent2_))),
      guide_(device, shaders::intrinsic_guide_guide, {}, 8, 8),
      cells_kernel_(device, shaders::intrinsic_guide_cells, {}, 4, 4),
      wide_kernel_(device, shaders::intrinsic_guide_wide, {}, 1, 1),
      sum_(device->kernel(shaders::intrinsic_guide_statistics, {kRows})),
      frame_(device->kernel(shaders::intrinsic_guide_frame, {}, kSumLanes)) {
  using gpu::Buffer;
  using gpu::Element;
  level0_ = Buffer::create(device, Element::vec4, extent_.pixels());
  level1_ = Buffer::create(device, Element::vec4, extent1_.pixels());
  cells_ = Buffer::create(device, Element::vec4, extent2_.pixels() * kCellStride);
  wide_ = Buffer::create(device, Element::vec4, extent4_.pixels());
  statistics_ = Buffer::create(device, Element::vec4, 2);
  for (auto& sums : sums_)
    sums = Buffer::create(device, Element::vec4, gpu::partial_count(*sum_, sum_items(extent1_)));
}

void Guide::record(gpu::Commands& commands, const gpu::BufferPtr& frame, const TileList* listed) {
  if (!cleared_)
    for (const auto& sums : sums_) commands.fill(sums);
  cleared_ = true;
  const auto size = [](Extent extent) {
    return std::array<uint32_t, 2>{extent.width, extent.height};
  };
  guide_.dispatch(commands, listed, {frame, level0_, level1_}, size(extent_),
                  line_of(extent1_.pixels()));
  cells_kernel_.dispatch(commands, listed, {level0_, cells_}, size(extent_),
                         line_of(extent2_.pixels()));
  wide_kernel_.dispatch(commands, listed, {cells_, wide_}, size(extent2_),
                        line_of(extent4_.pixels()));
  commands.dispatch(sum_, {level1_, sums_[0], sums_[1], sums_[2]}, size(extent1_),
                    sum_items(extent1_));
  commands.dispatch(frame_, {sums_[0], sums_[1], sums_[2], statistics_},
                    static_cast<uint32_t>(sums_[0]->count()), {});
}

}  // namespace inverse
