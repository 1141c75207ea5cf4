// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stroke_editor.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "decomposer.hpp"
#include "gst/base/color.hpp"
#include "gst/base/json/text_property.hpp"
#include "kernels/image/view/mosaic.hpp"
#include "stroke_properties.hpp"
#include "stroke_text.hpp"

namespace inverse {
namespace {

constexpr size_t kMaxUndo = 100;
constexpr float kUnsatisfied = 0.15F;      // rms, natural log units
constexpr unsigned kFramesToSatisfy = 10;  // of a stroke, before a warning

/// The property as it is now, for a frame of this size.
StrokeList strokes_of(const Log& log, Extent frame) {
  StrokeList list = read_strokes(text_property(log, "strokes"));
  if (list.frame.pixels() == 0) list.frame = frame;
  return list;
}

/// A point of `from`, in pixels of `to`.
Stroke::Point scaled(Stroke::Point point, Extent from, Extent to) {
  if (from.pixels() == 0 || to.pixels() == 0 || from == to) return point;
  return {point[0] * static_cast<float>(to.width) / static_cast<float>(from.width),
          point[1] * static_cast<float>(to.height) / static_cast<float>(from.height)};
}

/// The strokes of one sort out of `all`; `before`, if that has the same.
StrokesPtr part_of(const StrokeList& all, bool recolors, const StrokesPtr& before) {
  StrokeList part{.strokes = {}, .frame = all.frame};
  for (const Stroke& stroke : all.strokes)
    if ((stroke.kind == Stroke::Kind::recolor) == recolors) part.strokes.push_back(stroke);
  if (part.strokes.empty()) return nullptr;
  if (before && before->frame == part.frame && before->strokes == part.strokes) return before;
  return std::make_shared<const StrokeList>(std::move(part));
}

/// The kind of stroke that is drawn; none if the mouse draws none.
std::optional<Stroke::Kind> kind_of(StrokeMode mode) {
  switch (mode) {
    case StrokeMode::shading:
      return Stroke::Kind::shading;
    case StrokeMode::reflectance:
      return Stroke::Kind::reflectance;
    case StrokeMode::recolor:
      return Stroke::Kind::recolor;
    case StrokeMode::off:
    case StrokeMode::erase:
      break;
  }
  return {};
}

}  // namespace

std::string wrong_strokes(const GValue* value) {
  return wrong_text(value, "strokes", read_strokes);
}

void StrokeEditor::set(const Log& log, const StrokeList& list) {
  {
    std::string before = text_property(log, "strokes");
    const Lock lock(mutex_);
    undo_.push_back(std::move(before));
    if (undo_.size() > kMaxUndo) undo_.erase(undo_.begin());
  }
  g_object_set(log.object, "strokes", text_of(list).c_str(), nullptr);
}

void StrokeEditor::extend(Stroke::Point point) {
  const Stroke::Point& last = drawing_->points.back();
  const float step = std::max(drawing_->radius / 4, 1.0F);
  if (std::hypot(point[0] - last[0], point[1] - last[1]) < step) return;
  if (drawing_->points.size() == kMaxStrokePoints) {
    warnings_.push_back("the stroke has " + std::to_string(kMaxStrokePoints) +
                        " points and does not get longer; draw another one");
    drawing_->points.pop_back();
  }
  drawing_->points.push_back(point);
  drawing_changed_ = true;
}

Stroke::Point StrokeEditor::as_drawn(const Stroke& stroke, Stroke::Point now) const {
  const Lock lock(mutex_);
  for (size_t i = 0; i < places_.size(); ++i)
    if (checked_->strokes[i] == stroke) return places_[i].pose.as_drawn(now, places_[i].center);
  return now;
}

void StrokeEditor::mouse(const Log& log, const MouseEvent& event, const StrokeParams& params) {
  using Kind = MouseEvent::Kind;
  std::optional<Stroke> finished;
  Stroke::Point point{};
  Extent frame;
  {
    const Lock lock(mutex_);
    if (frame_.pixels() == 0 || !std::isfinite(event.x) || !std::isfinite(event.y)) return;
    constexpr double kFar = 1e6;
    double x = std::clamp(event.x, -kFar, kFar), y = std::clamp(event.y, -kFar, kFar);
    if (mosaic_) {
      const auto shown = Mosaic::shown_at(static_cast<int>(x), static_cast<int>(y), frame_);
      x = shown.first + 0.5, y = shown.second + 0.5;
    }
    point = {static_cast<float>(x), static_cast<float>(y)};
    frame = frame_;
    const auto kind = kind_of(params.stroke_mode);
    if (event.kind == Kind::press && kind) {
      drawing_ = Stroke{*kind, {point}, params.stroke_radius, params.stroke_fill};
      if (kind == Stroke::Kind::recolor) drawing_->color = linear_color(params.stroke_color);
      drawing_changed_ = true;
    } else if (drawing_) {
      extend(point);
      if (event.kind == Kind::release) finished = std::exchange(drawing_, std::nullopt);
    }
  }
  if (finished) {
    StrokeList list = strokes_of(log, frame);
    if (list.strokes.size() == kMaxStrokes) {
      const Lock lock(mutex_);
      drawing_changed_ = true;
      warnings_.push_back("there are " + std::to_string(kMaxStrokes) +
                          " strokes already; remove one to draw another");
      return;
    }
    for (Stroke::Point& at : finished->points) at = scaled(at, frame, list.frame);
    list.strokes.push_back(std::move(*finished));
    set(log, list);
  } else if (event.kind == Kind::press && params.stroke_mode == StrokeMode::erase) {
    StrokeList list = strokes_of(log, frame);
    const auto last =
        std::find_if(list.strokes.rbegin(), list.strokes.rend(), [&](const Stroke& stroke) {
          return covers(stroke, scaled(as_drawn(stroke, point), frame, list.frame));
        });
    if (last == list.strokes.rend()) return;
    list.strokes.erase(std::next(last).base());
    set(log, list);
  }
}

void StrokeEditor::add(const Log& log, const std::string& stroke) {
  Extent frame;
  {
    const Lock lock(mutex_);
    frame = frame_;
  }
  Stroke added = read_stroke(stroke);
  StrokeList list = strokes_of(log, frame);
  if (list.strokes.size() == kMaxStrokes)
    throw Error(ErrorKind::unsupported, "there are " + std::to_string(kMaxStrokes) +
                                            " strokes already; remove one to add another");
  for (Stroke::Point& at : added.points) at = scaled(at, frame, list.frame);
  list.strokes.push_back(std::move(added));
  set(log, list);
}

void StrokeEditor::remove(const Log& log, unsigned index) {
  StrokeList list = strokes_of(log, {});
  if (index < 1 || index > list.strokes.size())
    throw Error(ErrorKind::unsupported, "there is no stroke " + std::to_string(index) +
                                            "; there are " + std::to_string(list.strokes.size()));
  list.strokes.erase(list.strokes.begin() + (index - 1));
  set(log, list);
}

void StrokeEditor::clear(const Log& log) { set(log, {}); }

void StrokeEditor::undo(const Log& log) {
  std::string before;
  {
    const Lock lock(mutex_);
    if (undo_.empty()) throw Error(ErrorKind::unsupported, "no change of strokes is left to undo");
    before = std::move(undo_.back());
    undo_.pop_back();
  }
  g_object_set(log.object, "strokes", before.c_str(), nullptr);
}

bool StrokeEditor::changed(const std::string& strokes) const {
  const Lock lock(mutex_);
  return drawing_changed_ || strokes != taken_;
}

StrokeLists StrokeEditor::take(const std::string& strokes, Extent frame, bool mosaic) {
  const Lock lock(mutex_);
  mosaic_ = mosaic;
  const bool resized = std::exchange(frame_, frame) != frame;
  if (!drawing_changed_ && strokes == taken_ && !resized) return lists_;
  drawing_changed_ = false;
  taken_ = strokes;
  StrokeList list = read_strokes(strokes);
  if (list.frame.pixels() == 0) list.frame = frame;
  if (drawing_ && list.strokes.size() < kMaxStrokes) {
    list.strokes.push_back(*drawing_);
    for (Stroke::Point& at : list.strokes.back().points) at = scaled(at, frame, list.frame);
  }
  lists_.solved = part_of(list, false, lists_.solved);
  lists_.recolored = part_of(list, true, lists_.recolored);
  lists_.all = list.strokes.empty() ? nullptr : std::make_shared<const StrokeList>(std::move(list));
  return lists_;
}

void StrokeEditor::flush() {
  const Lock lock(mutex_);
  if (drawing_) drawing_changed_ = true;
  drawing_.reset();
}

void StrokeEditor::check(const StrokesPtr& list, const std::vector<float>& rms,
                         std::vector<StrokePlace> places) {
  const Lock lock(mutex_);
  if (list != checked_) checked_frames_ = 0, lost_ = false;
  ++checked_frames_;
  checked_ = list;
  places_ = std::move(places);
  if (drawing_) return;
  std::string lost;
  for (size_t i = 0; i < places_.size(); ++i)
    if (places_[i].pose.state == StrokeTracker::State::lost)
      lost += (lost.empty() ? "" : ", ") + std::to_string(i + 1);
  if (!lost.empty() && !std::exchange(lost_, true))
    warnings_.push_back(
        "what lies under these strokes is not found any more, so that they are not drawn until it "
        "is: " +
        lost + "; draw them again, or set stroke-follow=false to keep strokes in their place");
  if (checked_frames_ != kFramesToSatisfy) return;
  for (size_t i = 0; i < rms.size(); ++i) {
    if (!(rms[i] > kUnsatisfied)) continue;
    const bool shading = list->strokes[i].kind == Stroke::Kind::shading;
    warnings_.push_back(
        "stroke " + std::to_string(i + 1) + " of constant " +
        (shading ? "shading" : "reflectance") + " is not satisfied: " +
        (shading ? "shading" : "reflectance") + " varies by " + std::to_string(rms[i]) +
        " (rms of its logarithm) inside it; remove strokes that cut it in parts, or "
        "draw it where the surface has one " +
        (shading ? "shading" : "paint"));
  }
}

std::vector<Action> stroke_actions() {
  static constexpr auto kEditor = [](Filter& filter) -> StrokeEditor& {
    return *static_cast<Decomposer&>(filter).method().strokes();
  };
  return {{"add-stroke",
           {G_TYPE_STRING},
           [](Filter& filter, const GValue* stroke) {
             const char* text = g_value_get_string(stroke);
             kEditor(filter).add(filter.log(), text ? text : "");
           },
           true},
          {"remove-stroke",
           {G_TYPE_UINT},
           [](Filter& filter, const GValue* index) {
             kEditor(filter).remove(filter.log(), g_value_get_uint(index));
           },
           true},
          {"clear-strokes",
           {},
           [](Filter& filter, const GValue*) { kEditor(filter).clear(filter.log()); },
           true},
          {"undo-stroke",
           {},
           [](Filter& filter, const GValue*) { kEditor(filter).undo(filter.log()); },
           true}};
}

}  // namespace inverse
