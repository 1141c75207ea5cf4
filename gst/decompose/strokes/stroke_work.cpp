// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stroke_work.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace inverse {
namespace {

/// Whether the method solves with it, and finds a deviation.
bool is_solved(const Stroke& stroke) {
  return stroke.kind == Stroke::Kind::shading || stroke.kind == Stroke::Kind::reflectance;
}

/// `place`: null if no stroke is followed.
const char* state_of(const Stroke& stroke, bool seen, const StrokePlace* place) {
  if (stroke.in_scene()) return seen ? "in-scene" : "outside";
  switch (place ? place->pose.state : StrokeTracker::State::waiting) {
    case StrokeTracker::State::waiting:
      return "waiting";
    case StrokeTracker::State::followed:
      return "followed";
    case StrokeTracker::State::lost:
      return "lost";
    case StrokeTracker::State::outside:
      break;
  }
  return "outside";
}

}  // namespace

void StrokeWork::configure(const std::shared_ptr<gpu::Device>& device, Extent extent) {
  device_ = device;
  tracker_.reset();
  slots_.clear();
  recolor_.emplace(device, extent);
  select_.emplace(device, extent);
  pick_ = {device};
  frames_ = {};
}

void StrokeWork::release() {
  tracker_.reset();
  recolor_.reset();
  select_.reset();
  frames_ = {};
  device_.reset();
}

void StrokeWork::reset() {
  if (tracker_) tracker_->reset();
  if (recolor_) recolor_->reset();
  if (select_) select_->reset();
  slots_.clear();
}

bool StrokeWork::requested(const StrokeParams& params) const {
  return editor_.changed(params.strokes) || (lists_.all && params.stroke_follow != followed_) ||
         params.stroke_touch != touches_ ||
         (lists_.selected || params.stroke_mode == StrokeMode::select) != selects_;
}

void StrokeWork::take(FrameContext& frame, uint64_t number, const StrokeParams& params,
                      bool mosaic) {
  if (frame.fresh) reset();
  seen_ = nullptr;
  const Extent extent = frame.layers.extent;
  const StrokesPtr before = lists_.all;
  lists_ = editor_.take(params.strokes, extent, mosaic);
  for (std::string& warning : editor_.take_warnings()) frame.warnings.push_back(std::move(warning));
  for (StructurePtr& message : editor_.take_messages())
    frame.messages.push_back(std::move(message));
  followed_ = params.stroke_follow;
  touches_ = params.stroke_touch;
  // Without a stroke yet, elements that follow are to change nothing.
  selects_ = lists_.selected || params.stroke_mode == StrokeMode::select;
  follows_ =
      followed_ && lists_.all && !std::ranges::all_of(lists_.all->strokes, &Stroke::in_scene);
  number_ = number;
  Frame& now = frames_[number];
  now.lists = lists_;
  if (!follows_) {
    if (tracker_) tracker_->reset();
    slots_.clear();
  } else {
    if (!tracker_) tracker_.emplace(device_, extent);
    tracker_->record(frame.commands, lists_.all, *frame.layers[Role::input]);
    frame.commands.stage("follow-strokes");
    if (slots_.empty() || before != lists_.all) {
      slots_.clear();
      for (const Stroke& stroke : lists_.all->strokes) slots_.push_back(tracker_->slot_of(stroke));
    }
    if (!now.poses)
      now.poses = gpu::Buffer::create(device_, gpu::Element::vec4, tracker_->poses()->count(),
                                      gpu::Memory::readback);
    frame.commands.copy(tracker_->poses(), now.poses, now.poses->bytes());
  }
  now.slots = slots_;
  now.seen = false;
}

void StrokeWork::see(uint64_t number, const SeenStrokes* seen) {
  seen_ = seen;
  frames_[number].seen = seen != nullptr;
}

void StrokeWork::pick(FrameContext& frame) {
  Frame& now = frames_[number_];
  const auto place = editor_.take_pick();
  now.picks = place.has_value();
  if (!place) return;
  if (!now.color)
    now.color = gpu::Buffer::create(device_, gpu::Element::vec4, 1, gpu::Memory::readback);
  const auto pixel = [](float at, uint32_t size) {
    return static_cast<int32_t>(std::clamp(at, 0.0F, static_cast<float>(size - 1)));
  };
  const Extent size = frame.layers.extent;
  frame.commands.dispatch(
      pick_, {.plane = frame.layers[Role::intrinsic]->buffer, .color = now.color},
      {.size = size, .at = {pixel((*place)[0], size.width), pixel((*place)[1], size.height)}}, {});
}

void StrokeWork::edit(FrameContext& frame) {
  pick(frame);
  select_->record(frame.commands, frame.layers, selects_, lists_.selected, {tracker(), seen_});
  if (lists_.selected) frame.commands.stage("select-strokes");
  recolor_->record(frame.commands, frame.layers, lists_.recolored, {tracker(), seen_});
  if (lists_.recolored) frame.commands.stage("recolor-strokes");
}

std::vector<float> StrokeWork::residuals(const Frame& frame, const std::vector<float>& rms) {
  std::vector<float> result;
  auto next = rms.begin();
  for (const Stroke& stroke : frame.lists.all->strokes)
    result.push_back(!is_solved(stroke) || next == rms.end() ? 0 : *next++);
  return result;
}

std::vector<StrokePlace> StrokeWork::places(const Frame& frame) {
  std::vector<StrokePlace> result;
  const std::span poses(frame.poses ? frame.poses->map_as<float>() : nullptr,
                        frame.poses ? 4 * frame.poses->count() : 0);
  for (size_t i = 0; i < frame.slots.size(); ++i) {
    const auto& slot = frame.slots[i];
    if (frame.lists.all->strokes[i].in_scene())
      result.push_back({.pose = {.state = frame.seen ? StrokeTracker::State::followed
                                                     : StrokeTracker::State::outside}});
    else
      result.push_back({StrokeTracker::read(poses, slot.index), slot.center});
  }
  return result;
}

void StrokeWork::completed(const Log& log, uint64_t number, const std::vector<float>& rms,
                           const std::optional<SceneView>& view) {
  const Frame& frame = frames_[number];
  if (frame.picks) {
    const auto* color = frame.color->map_as<float>();
    StrokeEditor::pick(log, {color[0], color[1], color[2]});
  }
  if (!frame.lists.all) return;
  editor_.check(frame.lists.all, residuals(frame, rms), places(frame));
  if (view) editor_.see(log, *frame.lists.all, places(frame), *view);
}

void StrokeWork::describe(GstStructure* stats, uint64_t number,
                          const std::vector<float>& rms) const {
  const Frame& frame = frames_[number];
  if (!frame.lists.all) return;
  GValue deviations = G_VALUE_INIT, states = G_VALUE_INIT;
  const auto count = static_cast<guint>(frame.lists.all->strokes.size());
  gst_value_array_init(&deviations, count);
  for (const float residual : residuals(frame, rms)) {
    GValue entry = G_VALUE_INIT;
    g_value_init(&entry, G_TYPE_DOUBLE);
    g_value_set_double(&entry, static_cast<double>(residual));
    gst_value_array_append_and_take_value(&deviations, &entry);
  }
  gst_structure_take_value(stats, "strokes", &deviations);
  const bool in_scene = std::ranges::any_of(frame.lists.all->strokes, &Stroke::in_scene);
  if (frame.slots.empty() && !in_scene) return;
  gst_value_array_init(&states, count);
  const std::vector<StrokePlace> found = places(frame);
  for (size_t i = 0; i < count; ++i) {
    GValue entry = G_VALUE_INIT;
    g_value_init(&entry, G_TYPE_STRING);
    g_value_set_static_string(&entry, state_of(frame.lists.all->strokes[i], frame.seen,
                                               i < found.size() ? &found[i] : nullptr));
    gst_value_array_append_and_take_value(&states, &entry);
  }
  gst_structure_take_value(stats, "stroke-states", &states);
}

}  // namespace inverse
