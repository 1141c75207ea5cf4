#include "multigrid.hpp"

#include "../gpu/shaders.hpp"
#include "../image/pyramid.hpp"

INVERSE_SHADER(intrinsic_smooth);
INVERSE_SHADER(intrinsic_descend);
INVERSE_SHADER(intrinsic_ascend);
INVERSE_SHADER(intrinsic_coarse);

namespace inverse {
namespace {

constexpr uint64_t kTogether = 1200;  // quads from which on levels run in one dispatch: 80 x 60 pixels
constexpr uint32_t kSystemStride = 4;

struct LevelPush {
  uint32_t width, height;
  uint32_t color;
};

}  // namespace

Multigrid::Multigrid(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : smooth_(device->kernel(shaders::intrinsic_smooth)),
      descend_(device->kernel(shaders::intrinsic_descend)),
      ascend_(device->kernel(shaders::intrinsic_ascend)),
      coarse_(device->kernel(shaders::intrinsic_coarse, {}, device->limits().workgroup_invocations < 256 ? 128 : 256)) {
  const auto add = [&](Extent level, uint64_t quads) {
    levels_.push_back({level, gpu::Buffer::create(device, gpu::Element::vec4, quads * kSystemStride),
                       gpu::Buffer::create(device, gpu::Element::vec4, quads)});
  };
  for (; quads_of(extent) > kTogether; extent = half_of(extent), ++depth_) add(extent, quads_of(extent));
  uint64_t together = 0;
  for (Extent level = extent;; level = half_of(level), ++depth_) {
    together += quads_of(level);
    if (level.pixels() == 1) break;
  }
  add(extent, together);
}

void Multigrid::smooth(gpu::Commands& commands, const Level& level, uint32_t color) const {
  commands.dispatch(smooth_, {level.system, level.field, level.field},
                    LevelPush{level.extent.width, level.extent.height, color},
                    {(quads_of(level.extent.width) + 1) / 2 * ((level.extent.height + 3) / 4)});
}

void Multigrid::record(gpu::Commands& commands, const Params& params) const {
  for (size_t i = 0; i + 1 < levels_.size(); ++i) {
    const Level &fine = levels_[i], &coarse = levels_[i + 1];
    for (uint32_t pass = 0; pass < params.passes; ++pass)
      for (const uint32_t color : {0u, 1u}) smooth(commands, fine, color);
    const struct {
      uint32_t width, height;
      float scale;
    } push{fine.extent.width, fine.extent.height, params.scale};
    commands.dispatch(descend_, {fine.system, fine.field, coarse.system, coarse.field}, push,
                      {quads_of(coarse.extent.width) * coarse.extent.height});
  }
  const struct {
    uint32_t width, height;
    float scale;
    uint32_t passes;
  } push{levels_.back().extent.width, levels_.back().extent.height, params.scale, params.coarse_passes};
  commands.dispatch(coarse_, {levels_.back().system, levels_.back().field}, push, {1, 1, 1});
  for (size_t i = levels_.size() - 1; i-- > 0;) {
    const Level &fine = levels_[i], &coarse = levels_[i + 1];
    commands.dispatch(ascend_, {coarse.field, fine.field, fine.field},
                      LevelPush{fine.extent.width, fine.extent.height, 0},
                      {quads_of(fine.extent.width) * coarse.extent.height});
    for (uint32_t pass = 0; pass < params.passes; ++pass)
      for (const uint32_t color : {1u, 0u}) smooth(commands, fine, color);
  }
}

}  // namespace inverse
