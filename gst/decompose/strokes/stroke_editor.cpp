// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stroke_editor.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "common/number_text.hpp"
#include "gst/base/color.hpp"
#include "kernels/image/view/mosaic.hpp"
#include "stroke_properties.hpp"
#include "stroke_text.hpp"

namespace inverse {
namespace {

constexpr float kUnsatisfied = 0.15F;      // rms, natural log units
constexpr unsigned kFramesToSatisfy = 10;  // of a stroke, before a warning

/// The strokes of the property, for a frame of this size.
StrokeList strokes_of(const std::string& text, Extent frame) {
  StrokeList list = read_strokes(text);
  if (list.frame.pixels() == 0) list.frame = frame;
  return list;
}

/// The strokes of some kinds out of `all`; `before`, if that has the same.
StrokesPtr part_of(const StrokeList& all, std::initializer_list<Stroke::Kind> kinds,
                   const StrokesPtr& before) {
  StrokeList part{.strokes = {}, .frame = all.frame};
  for (const Stroke& stroke : all.strokes)
    if (std::ranges::find(kinds, stroke.kind) != kinds.end()) part.strokes.push_back(stroke);
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
    case StrokeMode::select:
      return Stroke::Kind::select;
    case StrokeMode::off:
    case StrokeMode::erase:
    case StrokeMode::pick:
      break;
  }
  return {};
}

/// Where a place of the scene is seen, in pixels of the frame.
Stroke::Point seen_at(const std::array<float, 3>& place, Extent frame, const SceneView& view) {
  const auto [x, y] = projected(view.lens, to_camera(view.pose, place));
  return scaled({x + 0.5F, y + 0.5F}, view.extent, frame);
}

StructurePtr began(const std::array<float, 3>& place, const Stroke::Point& point) {
  const auto number = [](float v) { return static_cast<double>(v); };
  return StructurePtr(gst_structure_new(
      "inverse-touch-began", "x", G_TYPE_DOUBLE, number(point[0]), "y", G_TYPE_DOUBLE,
      number(point[1]), "scene-x", G_TYPE_DOUBLE, number(place[0]), "scene-y", G_TYPE_DOUBLE,
      number(place[1]), "scene-z", G_TYPE_DOUBLE, number(place[2]), nullptr));
}

/// Adds a ball if it is half a radius away from the last one; returns whether it did.
bool extend_in_scene(std::vector<std::array<float, 4>>& balls, const std::array<float, 3>& place,
                     float radius) {
  if (balls.size() == json_list::kMaxPoints) return false;
  if (!balls.empty()) {
    const auto& last = balls.back();
    if (std::hypot(place[0] - last[0], place[1] - last[1], place[2] - last[2]) < radius / 2)
      return false;
  }
  balls.push_back({place[0], place[1], place[2], radius});
  return true;
}

}  // namespace

std::string wrong_strokes(const GValue* value) {
  return wrong_text(value, "strokes::list", read_strokes);
}

bool StrokeEditor::covers_now(const Stroke& stroke, Extent drawn, Stroke::Point point) const {
  const Lock lock(mutex_);
  if (stroke.in_scene()) return view_ && covers(stroke, point, frame_, *view_);
  for (size_t i = 0; i < places_.size(); ++i)
    if (checked_->strokes[i] == stroke) {
      point = places_[i].pose.as_drawn(point, places_[i].center);
      break;
    }
  return covers(stroke, scaled(point, frame_, drawn));
}

void StrokeEditor::mouse(const Log& log, const MouseEvent& event, const StrokeParams& params) {
  using Kind = MouseEvent::Kind;
  const auto place = mouse_place(event);
  if (!place) return;
  Stroke::Point point = *place;
  std::optional<Stroke> finished;
  Extent frame;
  {
    const Lock lock(mutex_);
    if (frame_.pixels() == 0) return;
    if (mosaic_) {
      const auto [x, y] =
          Mosaic::shown_at(static_cast<int>(point[0]), static_cast<int>(point[1]), frame_);
      point = {static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F};
    }
    frame = frame_;
    const auto kind = kind_of(params.stroke_mode);
    if (event.kind == Kind::press && kind) {
      drawing_ = Stroke{*kind, {point}, params.stroke_radius, params.stroke_fill};
      if (kind == Stroke::Kind::recolor) drawing_->color = linear_color(params.stroke_color);
      drawing_changed_ = true;
    } else if (event.kind == Kind::press && params.stroke_mode == StrokeMode::pick) {
      picked_ = point;
    } else if (drawing_) {
      if (extend(drawing_->points, point, drawing_->radius)) drawing_changed_ = true;
      if (event.kind == Kind::release) finished = std::exchange(drawing_, std::nullopt);
    }
  }
  if (finished)
    finish(log, *finished, frame);
  else if (event.kind == Kind::press && params.stroke_mode == StrokeMode::erase)
    erase_at(log, point, frame);
}

void StrokeEditor::finish(const Log& log, const Stroke& stroke, Extent frame) {
  change(log, [&](const std::string& text) -> std::optional<std::string> {
    StrokeList list = strokes_of(text, frame);
    if (list.strokes.size() == kMaxStrokes) {
      const Lock lock(mutex_);
      drawing_changed_ = true;
      warnings_.push_back(full(kMaxStrokes) + "; remove one to draw another");
      return {};
    }
    list.strokes.push_back(stroke);
    scale(list.strokes.back().points, frame, list.frame);
    return text_of(list);
  });
}

void StrokeEditor::erase_at(const Log& log, Stroke::Point point, Extent frame) {
  change(log, [&](const std::string& text) -> std::optional<std::string> {
    StrokeList list = strokes_of(text, frame);
    const auto last =
        std::find_if(list.strokes.rbegin(), list.strokes.rend(),
                     [&](const Stroke& stroke) { return covers_now(stroke, list.frame, point); });
    if (last == list.strokes.rend()) return {};
    list.strokes.erase(std::next(last).base());
    return text_of(list);
  });
}

void StrokeEditor::touch(const Log& log, const std::optional<Touch>& touch,
                         const std::optional<SceneView>& view, const StrokeParams& params) {
  using Event = TouchWatch::Event;
  std::optional<Stroke> finished;
  std::optional<Stroke::Point> point;
  Extent frame;
  Event event = Event::none;
  {
    const Lock lock(mutex_);
    frame = frame_;
    event = watch_.see(view ? touch : std::nullopt);
    if (event == Event::none) return;
    if (event == Event::ended) {
      finished = std::exchange(touched_, std::nullopt);
      messages_.emplace_back(gst_structure_new_empty("inverse-touch-ended"));
    } else {
      const auto kind = kind_of(params.stroke_mode);
      point = seen_at(touch->place, frame, *view);
      if (event == Event::began) {
        messages_.push_back(began(touch->place, *point));
        if (kind) {
          touched_ = Stroke{*kind, {}, Stroke{}.radius, params.stroke_fill};
          if (kind == Stroke::Kind::recolor) touched_->color = linear_color(params.stroke_color);
        }
      }
      const float radius = radius_in_scene(params.stroke_radius, touch->place, frame, *view);
      if (touched_ && extend_in_scene(touched_->balls, touch->place, radius))
        drawing_changed_ = true;
    }
  }
  if (finished) {
    finish(log, *finished, frame);
  } else if (event == Event::began && params.stroke_mode == StrokeMode::erase) {
    erase_at(log, *point, frame);
  } else if (event == Event::began && params.stroke_mode == StrokeMode::pick && touch->color) {
    pick(log, *touch->color);
  }
}

std::optional<Stroke::Point> StrokeEditor::take_pick() {
  const Lock lock(mutex_);
  return std::exchange(picked_, std::nullopt);
}

void StrokeEditor::pick(const Log& log, const std::array<float, 3>& color) {
  gst_child_proxy_set(GST_CHILD_PROXY(log.object), "strokes::color", srgb_color(color),
                      "strokes::mode", static_cast<int>(StrokeMode::recolor), nullptr);
}

std::vector<StructurePtr> StrokeEditor::take_messages() {
  const Lock lock(mutex_);
  return std::exchange(messages_, {});
}

void StrokeEditor::add(const Log& log, const std::string& stroke) {
  const Extent size = frame();
  const Stroke added = read_stroke(stroke);
  change(log, [&](const std::string& text) {
    StrokeList list = strokes_of(text, size);
    if (list.strokes.size() == kMaxStrokes)
      json_list::refuse(full(kMaxStrokes) + "; remove one to add another");
    list.strokes.push_back(added);
    scale(list.strokes.back().points, size, list.frame);
    return text_of(list);
  });
}

void StrokeEditor::add_loaded(const Log& log, const std::vector<Stroke>& strokes) {
  if (strokes.empty()) return;
  bool left_out = false;
  amend(log, [&](const std::string& text) {
    StrokeList list = read_strokes(text);
    for (const Stroke& stroke : strokes) {
      if (std::ranges::find(list.strokes, stroke) != list.strokes.end()) continue;
      if (list.strokes.size() == kMaxStrokes)
        left_out = true;
      else
        list.strokes.push_back(stroke);
    }
    return text_of(list);
  });
  if (!left_out) return;
  const Lock lock(mutex_);
  warnings_.push_back(full(kMaxStrokes) + "; some of the scene's are left out");
}

void StrokeEditor::remove(const Log& log, unsigned index) {
  change(log, [&](const std::string& text) {
    StrokeList list = read_strokes(text);
    erase(list.strokes, index);
    return text_of(list);
  });
}

bool StrokeEditor::changed(const std::string& strokes) const {
  const Lock lock(mutex_);
  return drawing_changed_ || picked_ || strokes != taken_;
}

StrokeLists StrokeEditor::take(const std::string& strokes, Extent frame, bool mosaic) {
  const Lock lock(mutex_);
  mosaic_ = mosaic;
  const bool resized = std::exchange(frame_, frame) != frame;
  if (!drawing_changed_ && strokes == taken_ && !resized) return lists_;
  drawing_changed_ = false;
  const bool changed = std::exchange(taken_, strokes) != strokes;
  StrokeList list = strokes_of(strokes, frame);
  if ((changed || resized) && !list.strokes.empty()) {
    const UselessStrokes useless = find_useless(list);
    warnings_.push_back(outside_of(useless.outside, list.frame));
    warnings_.push_back(under_others(useless.under, "shading, reflectance"));
    std::erase(warnings_, "");
  }
  if (touched_ && !touched_->balls.empty() && list.strokes.size() < kMaxStrokes)
    list.strokes.push_back(*touched_);
  if (drawing_ && list.strokes.size() < kMaxStrokes) {
    list.strokes.push_back(*drawing_);
    scale(list.strokes.back().points, frame, list.frame);
  }
  using Kind = Stroke::Kind;
  lists_.solved = part_of(list, {Kind::shading, Kind::reflectance}, lists_.solved);
  lists_.recolored = part_of(list, {Kind::recolor}, lists_.recolored);
  lists_.selected = part_of(list, {Kind::select}, lists_.selected);
  lists_.all = list.strokes.empty() ? nullptr : std::make_shared<const StrokeList>(std::move(list));
  return lists_;
}

void StrokeEditor::flush() {
  const Lock lock(mutex_);
  if (drawing_ || touched_) drawing_changed_ = true;
  drawing_.reset();
  touched_.reset();
  watch_.forget();
  picked_.reset();
}

void StrokeEditor::forget_scene() {
  const Lock lock(mutex_);
  view_.reset();
  if (std::exchange(touched_, std::nullopt)) drawing_changed_ = true;
  watch_.forget();
}

bool StrokeEditor::places(const StrokeList& list) {
  return !std::ranges::all_of(list.strokes, &Stroke::in_scene);
}

void StrokeEditor::see(const Log& log, const StrokeList& list,
                       const std::vector<StrokePlace>& places, const SceneView& view) {
  std::vector<std::pair<Stroke, Stroke>> placed;
  {
    const Lock lock(mutex_);
    view_ = view;
    view_->depth = {};
    if (view.depth.empty()) return;
    for (size_t i = 0; i < list.strokes.size(); ++i) {
      const Stroke& stroke = list.strokes[i];
      if (stroke.in_scene() || (drawing_ && i + 1 == list.strokes.size())) continue;
      Stroke now = stroke;
      if (i < places.size()) {
        if (places[i].pose.state != StrokeTracker::State::followed &&
            places[i].pose.state != StrokeTracker::State::waiting)
          continue;
        for (Stroke::Point& point : now.points)
          point = scaled(places[i].pose.now(scaled(point, list.frame, frame_), places[i].center),
                         frame_, list.frame);
      }
      if (auto there = placed_in_scene(now, list.frame, view))
        placed.emplace_back(stroke, std::move(*there));
    }
  }
  if (placed.empty()) return;
  amend(log, [&](const std::string& text) {
    StrokeList changed = read_strokes(text);
    bool any = false;
    for (Stroke& stroke : changed.strokes)
      for (const auto& [from, to] : placed)
        if (stroke == from) {
          stroke = to;
          any = true;
          break;
        }
    return any ? text_of(changed) : text;
  });
}

void StrokeEditor::check(const StrokesPtr& list, const std::vector<float>& rms,
                         std::vector<StrokePlace> places) {
  const Lock lock(mutex_);
  if (list != checked_) checked_frames_ = 0, lost_ = false;
  ++checked_frames_;
  checked_ = list;
  places_ = std::move(places);
  if (drawing_ || touched_) return;
  std::string lost;
  for (size_t i = 0; i < places_.size(); ++i)
    if (places_[i].pose.state == StrokeTracker::State::lost)
      lost += (lost.empty() ? "" : ", ") + std::to_string(i + 1);
  if (!lost.empty() && !std::exchange(lost_, true))
    warnings_.push_back(
        "what lies under these strokes is not found any more, so that they are not drawn until it "
        "is: " +
        lost + "; draw them again, or set strokes::follow=false to keep strokes in their place");
  if (checked_frames_ != kFramesToSatisfy) return;
  for (size_t i = 0; i < rms.size(); ++i) {
    if (!(rms[i] > kUnsatisfied)) continue;
    const bool shading = list->strokes[i].kind == Stroke::Kind::shading;
    warnings_.push_back(
        "stroke " + std::to_string(i + 1) + " of constant " +
        (shading ? "shading" : "reflectance") + " is not satisfied: " +
        (shading ? "shading" : "reflectance") + " varies by " + number_text(double{rms[i]}) +
        " (rms of its logarithm) inside it; remove strokes that cut it in parts, or "
        "draw it where the surface has one " +
        (shading ? "shading" : "paint"));
  }
}

}  // namespace inverse
