#include "active_tiles.hpp"

#include <algorithm>
#include <string>

#include "common/error.hpp"
#include "kernels/gpu/shaders.hpp"
#include "kernels/image/pyramid.hpp"

INVERSE_SHADER(intrinsic_reuse_active);
INVERSE_SHADER(intrinsic_reuse_activity);
INVERSE_SHADER(intrinsic_reuse_spread);

namespace inverse {

ActiveTiles::ActiveTiles(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      lists_{TileList(device, extent), TileList(device, extent)},
      drawn_(device, extent),
      active_(device->kernel(shaders::intrinsic_reuse_active)),
      spread_(device->kernel(shaders::intrinsic_reuse_spread)),
      look_(device, shaders::intrinsic_reuse_activity, {}, 1, 1),
      activity_(gpu::Buffer::create(device, gpu::Element::vec4, tiles())),
      busy_(gpu::Buffer::create(device, gpu::Element::word, 1)) {
  for (auto& changed : changed_)
    changed = gpu::Buffer::create(device, gpu::Element::word, tiles(), gpu::Memory::upload);
}

float ActiveTiles::take(std::span<const uint8_t> changed) {
  if (changed.empty()) return 1;
  if (changed.size() != tiles())
    throw Error(ErrorKind::internal, "told of " + std::to_string(changed.size()) +
                                         " tiles of a frame that has " + std::to_string(tiles()));
  frame_ = (frame_ + 1) % changed_.size();
  std::copy(changed.begin(), changed.end(), changed_[frame_]->map_as<uint32_t>());
  const auto concerned = spread_tiles(changed, lists_[0].columns());
  return static_cast<float>(std::count(concerned.begin(), concerned.end(), 1)) /
         static_cast<float>(tiles());
}

void ActiveTiles::record_list(gpu::Commands& commands, const gpu::BufferPtr& correction,
                              float tolerance, float hold) {
  now_ = 1 - now_;
  const TileList& list = lists_[now_];
  const Extent cells = half_of(half_of(extent_));
  const struct {
    uint32_t columns, rows, cell_quads, cell_rows;
    float tolerance, hold;
  } push{list.columns(), list.rows(), quads_of(cells.width), cells.height, tolerance, hold};
  commands.dispatch(active_, {changed_[frame_], correction, activity_, list.flags()}, push,
                    line_of(tiles()));
  list.record(commands);
  const std::array<uint32_t, 2> grid{list.columns(), list.rows()};
  commands.dispatch(spread_, {list.flags(), drawn_.flags()}, grid, line_of(tiles()));
  drawn_.record(commands);
}

void ActiveTiles::record_activity(gpu::Commands& commands, const gpu::BufferPtr& before,
                                  const gpu::BufferPtr& now, const TileList* listed,
                                  float tolerance) {
  const uint32_t columns = lists_[0].columns();
  const struct {
    uint32_t columns, rows, quads, quad_rows, width, height;
    float tolerance;
  } push{columns,        lists_[0].rows(), quads_of(extent_.width), extent_.height, extent_.width,
         extent_.height, tolerance};
  commands.fill(busy_);
  look_.dispatch(commands, listed, {changed_[frame_], before, now, activity_, busy_}, push,
                 line_of(tiles()));
}

}  // namespace inverse
