// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stroke_mask.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "kernels/image/pack4.hpp"

namespace inverse {
namespace {

using Moved = shaders::image_strokes_commit;

}  // namespace

StrokeMask::StrokeMask(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      extent_(extent),
      place_(device),
      place_followed_(device, {.followed = true}),
      draw_(device),
      project_(device),
      commit_(device),
      reflectance_(device),
      fill_(device, extent) {}

void StrokeMask::set(gpu::Commands& commands, const StrokesPtr& list, const Places& places) {
  forget();
  list_ = list;
  tracker_ = places.tracker;
  if (!list || list->strokes.empty()) return;
  using Shader = shaders::image_strokes_place;
  const StrokePatches patches = draw_patches(*list, extent_);
  count_ = static_cast<uint32_t>(patches.patches.size());
  step_ = static_cast<float>(patches.step);
  std::vector<std::array<float, 4>> table(size_t{count_} * Shader::DRAWN_STRIDE);
  for (size_t i = 0; i < count_; ++i) {
    const Stroke& stroke = list->strokes[i];
    const StrokePatches::Patch& patch = patches.patches[i];
    const auto followed = tracker_ ? tracker_->slot_of(stroke) : StrokeTracker::Slot{};
    // What is filled in the scene is in its image.
    const bool fills = stroke.fill && !stroke.in_scene();
    fills_ = fills_ || fills;
    in_scene_ = in_scene_ || stroke.in_scene();
    auto* entry = &table[Shader::DRAWN_STRIDE * i];
    entry[Shader::DRAWN_KIND] = {static_cast<float>(stroke.kind), fills ? 1.0F : 0.0F,
                                 static_cast<float>(followed.index),
                                 stroke.in_scene() ? 1.0F : 0.0F};
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
    always_ = gpu::make_table(device_, gpu::Element::word,
                              std::vector<uint32_t>(Moved::MOVED_STROKES + 1, 1));
  }
  numbers_.clear();
  take_numbers(commands, places.seen);
  place(commands, mask_, places.seen);
}

void StrokeMask::take_numbers(gpu::Commands& commands, const SeenStrokes* seen) {
  if (!seen || !in_scene_) return;
  std::vector<uint32_t> numbers(seen->strokes.size() + 1);
  for (uint32_t i = 0; i < count_; ++i)
    if (list_->strokes[i].in_scene()) numbers[seen->id_of(list_->strokes[i])] = i + 1;
  numbers[0] = 0;
  if (numbers == numbers_) return;
  numbers_ = std::move(numbers);
  commands.write_table(number_table_, gpu::Element::word, numbers_);
}

void StrokeMask::place(gpu::Commands& commands, const gpu::BufferPtr& mask,
                       const SeenStrokes* seen) {
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
  if (!seen || !in_scene_) return;
  commands.dispatch(project_,
                    {.ids = seen->ids,
                     .known_depth = seen->known_depth,
                     .depth = seen->depth,
                     .valid = seen->valid,
                     .numbers = number_table_,
                     .mask = mask},
                    {.size = extent_, .seen = seen->extent}, line_of(pack4_count(extent_)));
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

void StrokeMask::fill(gpu::Commands& commands, const Reflectance& of, const SeenStrokes* seen) {
  if (of.frame && !reflectance_now_)
    reflectance_now_ = gpu::Buffer::create(device_, gpu::Element::vec4, extent_.pixels());
  take_numbers(commands, seen);
  if (moves()) place(commands, mask_, seen);
  extend(commands, mask_, of);
  filled_ = true;
}

void StrokeMask::follow(gpu::Commands& commands, const Reflectance& of, const SeenStrokes* seen) {
  if (!next_) {
    next_ = gpu::Buffer::create(device_, gpu::Element::vec4, pack4_count(extent_));
    changed_ = gpu::Buffer::create(device_, gpu::Element::word, TileList::count(extent_));
  }
  commands.fill(changed_);
  take_numbers(commands, seen);
  const auto draw_again = [&] {
    place(commands, next_, seen);
    if (filled_) extend(commands, next_, of);
    commands.dispatch(commit_,
                      {.next = next_, .moved = moved(), .mask = mask_, .changed = changed_},
                      {.size = extent_}, line_of(pack4_count(extent_)));
  };
  commands.when(moved(), sizeof(uint32_t) * Moved::MOVED_STROKES, draw_again);
}

const gpu::BufferPtr& StrokeMask::moved() const { return in_scene_ ? always_ : tracker_->moved(); }

}  // namespace inverse
