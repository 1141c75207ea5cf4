// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stroke_tracker.hpp"

#include <algorithm>
#include <cstddef>

#include "kernels/image/pack4.hpp"
#include "kernels/image/pyramid.hpp"

namespace inverse {
namespace {

using Track = shaders::image_strokes_track;
static_assert(StrokeSamples::kMax == Track::kSamples &&
              StrokeSamples::kMaxLevel + 1 == Track::kLevels);

}  // namespace

StrokeTracker::StrokeTracker(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      extent_(extent),
      halve_frame_(device, {.frame = true}),
      halve_(device),
      check_(device, {.check = true}, device->variant().area_workgroup()),
      track_(device, {}, device->variant().area_workgroup()) {}

void StrokeTracker::take(gpu::Commands& commands, const StrokesPtr& list) {
  list_ = list;
  count_ = static_cast<uint32_t>(std::min(list->strokes.size(), kMaxStrokes));
  for (auto& slot : slots_)
    if (slot) slot->kept = false;
  std::vector<const Stroke*> added;
  for (size_t i = 0; i < count_; ++i) {
    const Stroke& stroke = list->strokes[i];
    if (stroke.in_scene()) continue;
    const auto known = std::find_if(slots_.begin(), slots_.end(), [&](const auto& slot) {
      return slot && !slot->kept && slot->frame == list->frame && slot->stroke == stroke;
    });
    if (known == slots_.end())
      added.push_back(&stroke);
    else
      (*known)->kept = true, (*known)->fresh = false;
  }
  for (auto& slot : slots_)
    if (slot && !slot->kept) slot.reset();
  sample_table_.resize(kMaxStrokes * Track::kSamples);
  for (const Stroke* stroke : added) {
    const auto slot = std::find(slots_.begin(), slots_.end(), std::nullopt);
    slot->emplace(Followed{.stroke = *stroke,
                           .frame = list->frame,
                           .samples = samples_of(*stroke, list->frame, extent_)});
    const auto& samples = (*slot)->samples.samples;
    std::copy(samples.begin(), samples.end(),
              sample_table_.begin() + (slot - slots_.begin()) * std::ptrdiff_t{Track::kSamples});
  }
  fresh_ = !added.empty();
  if (fresh_) commands.write_table(samples_, gpu::Element::vec4, sample_table_);
  write_strokes(commands);
}

void StrokeTracker::write_strokes(gpu::Commands& commands) {
  std::vector<std::array<float, 4>> table;
  for (size_t i = 0; i < slots_.size(); ++i) {
    if (!slots_[i]) continue;
    const Followed& of = *slots_[i];
    table.push_back({static_cast<float>(i), of.fresh ? 1.0F : 0.0F,
                     static_cast<float>(of.samples.samples.size()),
                     static_cast<float>(of.samples.levels)});
    table.push_back({of.samples.center[0], of.samples.center[1], of.samples.radius, 0});
  }
  commands.write_table(strokes_, gpu::Element::vec4, table);
}

void StrokeTracker::record(gpu::Commands& commands, const StrokesPtr& list, const Plane& frame) {
  if (!poses_) {
    const auto buffer = [&](gpu::Element element, uint64_t count) {
      return gpu::Buffer::create(device_, element, count);
    };
    poses_ = buffer(gpu::Element::vec4, kMaxStrokes * Track::POSE_STRIDE);
    templates_ = buffer(gpu::Element::vec4, kMaxStrokes * Track::kLevels * Track::kSamples);
    moved_ = buffer(gpu::Element::word, Track::MOVED_SLOTS + kMaxStrokes);
    pyramid_ = buffer(gpu::Element::scalar, half_of(extent_).pixels() * 3 / 2 + 64);
    commands.fill(poses_);
    commands.fill(templates_);
  }
  if (list != list_) {
    take(commands, list);
  } else if (fresh_) {
    for (auto& slot : slots_)
      if (slot) slot->fresh = false;
    fresh_ = false;
    write_strokes(commands);
  }
  commands.fill(moved_);
  const Track::Buffers buffers{.strokes = strokes_,
                               .samples = samples_,
                               .frame = frame.buffer,
                               .pyramid = pyramid_,
                               .poses = poses_,
                               .templates = templates_,
                               .moved = moved_};
  commands.dispatch(check_, buffers, {.size = extent_},
                    line_of(uint64_t{count_} * check_.kernel()->workgroup()));
  uint32_t levels = 0;
  for (const auto& slot : slots_)
    if (slot) levels = std::max(levels, slot->samples.levels);
  commands.when(moved_, sizeof(uint32_t) * Track::MOVED_ANY, [&] {
    Extent fine = extent_;
    uint32_t from = 0, to = 0;
    for (uint32_t level = 0; level < levels; ++level) {
      const Extent coarse = half_of(fine);
      commands.dispatch(level == 0 ? halve_frame_ : halve_,
                        {.frame = frame.buffer, .pyramid = pyramid_},
                        {.fine_size = fine, .size = coarse, .fine = from, .coarse = to},
                        {coarse.width, coarse.height});
      from = to;
      to += static_cast<uint32_t>(coarse.pixels());
      fine = coarse;
    }
    commands.dispatch(track_, buffers, {.size = extent_},
                      line_of(uint64_t{count_} * track_.kernel()->workgroup()));
  });
}

StrokeTracker::Slot StrokeTracker::slot_of(const Stroke& stroke) const {
  if (stroke.in_scene()) return {};
  for (uint32_t i = 0; i < slots_.size(); ++i)
    if (slots_[i] && slots_[i]->stroke == stroke) return {i, slots_[i]->samples.center};
  throw Error(ErrorKind::internal, "a stroke is not followed");
}

StrokeTracker::Pose StrokeTracker::read(std::span<const float> poses, uint32_t slot) {
  const auto* at = &poses[size_t{kPoseNumbers} * slot];
  const float* place = at + 4 * Track::POSE_PLACE;
  return {{place[0], place[1]},
          {place[2], place[3]},
          static_cast<State>(static_cast<uint8_t>(at[4 * Track::POSE_STATE]))};
}

Stroke::Point StrokeTracker::Pose::now(Stroke::Point drawn, Stroke::Point center) const {
  const float x = drawn[0] - center[0], y = drawn[1] - center[1];
  return {center[0] + shift[0] + turn[0] * x - turn[1] * y,
          center[1] + shift[1] + turn[1] * x + turn[0] * y};
}

Stroke::Point StrokeTracker::Pose::as_drawn(Stroke::Point now, Stroke::Point center) const {
  const float x = now[0] - center[0] - shift[0], y = now[1] - center[1] - shift[1],
              squares = std::max(turn[0] * turn[0] + turn[1] * turn[1], 1e-12F);
  return {center[0] + (x * turn[0] + y * turn[1]) / squares,
          center[1] + (y * turn[0] - x * turn[1]) / squares};
}

}  // namespace inverse
