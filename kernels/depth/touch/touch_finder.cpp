// SPDX-License-Identifier: LGPL-2.1-or-later
#include "touch_finder.hpp"

#include <cmath>

#include "kernels/gpu/reduce.hpp"

namespace inverse {
namespace {

using shaders::depth_touch_choose;
using shaders::depth_touch_points;

constexpr uint32_t kTile = depth_touch_points::TOUCH_TILE;
constexpr uint32_t kPasses = 8;  // of growth, two pixels each; even: the last one writes kinds_[0]
static_assert(kPasses % 2 == 0);
constexpr float kMinArea = 1e-5F;  // m²: skin that is near by chance is less

}  // namespace

TouchFinder::TouchFinder(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      compare_(device),
      grow_(device),
      points_(device, {}, kTile * kTile),
      choose_(device, {}, gpu::kOneGroup),
      background_(device),
      any_(gpu::Buffer::create(device, gpu::Element::word, 1)),
      sums_(gpu::Buffer::create(device, gpu::Element::vec4,
                                tiles().pixels() * depth_touch_points::TOUCH_STRIDE)),
      touch_(gpu::Buffer::create(device, gpu::Element::vec4, depth_touch_choose::TOUCH_RESULT)),
      arm_(gpu::Buffer::create(device, gpu::Element::word, depth_touch_choose::TOUCH_ARM_WORDS)) {
  for (gpu::BufferPtr& kinds : kinds_)
    kinds = gpu::Buffer::create(device, gpu::Element::word, extent.pixels());
}

Extent TouchFinder::tiles() const {
  return {(extent_.width + kTile - 1) / kTile, (extent_.height + kTile - 1) / kTile};
}

void TouchFinder::record(gpu::Commands& commands, const Frame& frame, const Volume::View& view) {
  const auto pixels = static_cast<uint32_t>(extent_.pixels());
  for (const gpu::BufferPtr& buffer : {any_, touch_, arm_}) commands.fill(buffer);
  commands.dispatch(compare_,
                    {.surface = frame.surface,
                     .view_depth = view.depth,
                     .layers = frame.layers,
                     .found = frame.found,
                     .kinds = kinds_[0],
                     .any = any_},
                    {.size = extent_}, pixels);
  commands.when(any_, 0, [&] {
    for (uint32_t pass = 0; pass < kPasses; ++pass)
      commands.dispatch(
          grow_,
          {.kinds = kinds_[pass % 2], .surface = frame.surface, .grown = kinds_[(pass + 1) % 2]},
          {.size = extent_}, pixels);
    commands.dispatch(points_,
                      {.kinds = kinds_[0],
                       .surface = frame.surface,
                       .view_depth = view.depth,
                       .view_surface = view.surface,
                       .reflectance = view.reflectance,
                       .sums = sums_},
                      {.lens = frame.lens.values(), .size = extent_},
                      static_cast<uint32_t>(tiles().pixels()) * kTile * kTile);
    commands.dispatch(choose_, {.sums = sums_, .pose = frame.pose, .touch = touch_, .arm = arm_},
                      {.lens = frame.lens.values(), .tiles = tiles()}, gpu::kOneGroup);
  });
}

void TouchFinder::record_background(gpu::Commands& commands, const gpu::BufferPtr& depth) const {
  commands.dispatch(background_, {.kinds = kinds_[0], .arm = arm_, .depth = depth},
                    {.size = extent_}, static_cast<uint32_t>(extent_.pixels()));
}

std::optional<Touch> TouchFinder::read(const float* result) {
  Touch touch{.place = {result[0], result[1], result[2]},
              .color = {},
              .area = result[3],
              .distance = result[8]};
  if (!(touch.area > kMinArea)) return {};
  if (result[7] > 0) touch.color = {std::exp(result[4]), std::exp(result[5]), std::exp(result[6])};
  return touch;
}

float TouchFinder::front(const float* result) { return result[10]; }

}  // namespace inverse
