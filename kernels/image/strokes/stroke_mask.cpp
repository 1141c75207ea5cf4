// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stroke_mask.hpp"

#include <algorithm>
#include <array>

#include "kernels/image/pack4.hpp"

namespace inverse {

StrokeMask::StrokeMask(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      extent_(extent),
      place_(device),
      place_followed_(device, {.followed = true}),
      draw_(device),
      commit_(device),
      reflectance_(device),
      fill_(device, extent) {}

void StrokeMask::set(gpu::Commands& commands, const StrokesPtr& list,
                     const StrokeTracker* tracker) {
  forget();
  list_ = list;
  tracker_ = tracker;
  if (!list || list->strokes.empty()) return;
  using Shader = shaders::image_strokes_place;
  const StrokePatches patches = draw_patches(*list, extent_);
  count_ = static_cast<uint32_t>(patches.patches.size());
  step_ = static_cast<float>(patches.step);
  std::vector<std::array<float, 4>> table(size_t{count_} * Shader::DRAWN_STRIDE);
  for (size_t i = 0; i < count_; ++i) {
    const Stroke& stroke = list->strokes[i];
    const StrokePatches::Patch& patch = patches.patches[i];
    const auto followed = tracker ? tracker->slot_of(stroke) : StrokeTracker::Slot{};
    fills_ = fills_ || stroke.fill;
    auto* entry = &table[Shader::DRAWN_STRIDE * i];
    entry[Shader::DRAWN_KIND] = {static_cast<float>(stroke.kind), stroke.fill ? 1.0F : 0.0F,
                                 static_cast<float>(followed.index), 0};
    entry[Shader::DRAWN_COLOR] = {stroke.color[0], stroke.color[1], stroke.color[2], 0};
    entry[Shader::DRAWN_PATCH] = {static_cast<float>(patch.left), static_cast<float>(patch.top),
                                  static_cast<float>(patch.width),
                                  static_cast<float>(patch.height)};
    entry[Shader::DRAWN_CENTER] = {followed.center[0], followed.center[1],
                                   static_cast<float>(patch.first), 0};
  }
  commands.write_table(drawn_, gpu::Element::vec4, table);
  commands.write_table(depths_, gpu::Element::scalar, patches.depths);
  if (!mask_) {
    mask_ = gpu::Buffer::create(device_, gpu::Element::vec4, pack4_count(extent_));
    strokes_ = gpu::Buffer::create(device_, gpu::Element::vec4,
                                   kMaxStrokes * shaders::image_strokes_draw::STROKE_STRIDE);
  }
  place(commands, mask_);
}

void StrokeMask::place(gpu::Commands& commands, const gpu::BufferPtr& mask) {
  const Extent frame = tracker_ ? tracker_->extent() : extent_;
  commands.dispatch(
      tracker_ ? place_followed_ : place_,
      {.drawn = drawn_, .poses = tracker_ ? tracker_->poses() : drawn_, .strokes = strokes_},
      {.size = extent_,
       .scale = {static_cast<float>(extent_.width) / static_cast<float>(frame.width),
                 static_cast<float>(extent_.height) / static_cast<float>(frame.height)},
       .count = count_,
       .step = step_},
      line_of(count_));
  commands.dispatch(draw_, {.strokes = strokes_, .depths = depths_, .mask = mask},
                    {.size = extent_, .count = count_}, line_of(pack4_count(extent_)));
}

void StrokeMask::extend(gpu::Commands& commands, const gpu::BufferPtr& mask,
                        const Reflectance& of) {
  gpu::BufferPtr reflectance = of.reflectance;
  if (of.frame) {
    reflectance = reflectance_now_;
    commands.dispatch(reflectance_,
                      {.before = of.reflectance,
                       .frame_before = of.frame_before,
                       .frame = of.frame,
                       .reflectance = reflectance},
                      {.size = extent_}, {extent_.width, extent_.height});
  }
  fill_.record(commands, mask, strokes_, count_, reflectance);
}

void StrokeMask::fill(gpu::Commands& commands, const Reflectance& of) {
  if (of.frame && !reflectance_now_)
    reflectance_now_ = gpu::Buffer::create(device_, gpu::Element::vec4, extent_.pixels());
  if (tracker_) place(commands, mask_);
  extend(commands, mask_, of);
  filled_ = true;
}

void StrokeMask::follow(gpu::Commands& commands, const Reflectance& of) {
  if (!next_) {
    next_ = gpu::Buffer::create(device_, gpu::Element::vec4, pack4_count(extent_));
    changed_ = gpu::Buffer::create(device_, gpu::Element::word, TileList::count(extent_));
  }
  commands.fill(changed_);
  using Moved = shaders::image_strokes_commit;
  commands.when(tracker_->moved(), sizeof(uint32_t) * Moved::MOVED_STROKES, [&] {
    place(commands, next_);
    if (filled_) extend(commands, next_, of);
    commands.dispatch(
        commit_, {.next = next_, .moved = tracker_->moved(), .mask = mask_, .changed = changed_},
        {.size = extent_}, line_of(pack4_count(extent_)));
  });
}

}  // namespace inverse
