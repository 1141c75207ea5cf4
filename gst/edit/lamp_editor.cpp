// SPDX-License-Identifier: LGPL-2.1-or-later
#include "lamp_editor.hpp"

#include <algorithm>
#include <cmath>

#include "lamp_text.hpp"

namespace inverse {
namespace {

constexpr float kGrasp = 1.F / 30;  // of the longer side of the frame: how near a press must be
constexpr const char* kRemoveOne = "; remove one to add another";

/// The lamps of the property, in pixels of `frame` if it names none.
LampList lamps_of(const std::string& text, Extent frame) {
  LampList list = read_lamps(text);
  if (list.frame.pixels() == 0) list.frame = frame;
  return list;
}

/// From pixels of `from` to those of `to`.
void scale(Lamp& lamp, Extent from, Extent to) {
  if (lamp.room) return;
  const Place at = scaled({lamp.position[0], lamp.position[1]}, from, to);
  lamp.position[0] = at[0], lamp.position[1] = at[1];
}

using KnownView = const std::optional<LampView>&;

/// The place of a lamp of a list, in pixels of `frame`; none if that is not known.
std::optional<Place> place_in(const Lamp& lamp, Extent own, Extent frame, KnownView view) {
  if (!lamp.room) return scaled(place_of(lamp, own), own, frame);
  const std::optional<Lamp> seen = view ? view->over(lamp, frame) : std::nullopt;
  return seen ? std::optional(place_of(*seen, frame)) : std::nullopt;
}

/// Moves a lamp of a list to a place in pixels of `frame`; one in the room stays as far from the
/// camera as it is.
void move_lamp(Lamp& lamp, Extent own, Place to, Extent frame, KnownView view) {
  if (!lamp.room) return move_to(lamp, scaled(to, frame, own), own);
  std::optional<Lamp> seen = view ? view->over(lamp, frame) : std::nullopt;
  if (!seen) return;
  move_to(*seen, to, frame);
  Lamp moved = view->in_room(*seen, frame);
  // Turned there and back, a direction that did not change would not be quite the same.
  if (lamp.kind != Lamp::Kind::directional) moved.direction = lamp.direction;
  lamp = moved;
}

/// The lamp that is nearest to a place within reach, if one is.
std::optional<size_t> lamp_at(const LampList& list, Place place, Extent frame, KnownView view) {
  std::optional<size_t> nearest;
  float min_distance =
      std::max(static_cast<float>(std::max(frame.width, frame.height)) * kGrasp, 4.F);
  for (size_t i = 0; i < list.lamps.size(); ++i) {
    const auto at = place_in(list.lamps[i], list.frame, frame, view);
    if (!at) continue;
    const float off = std::hypot((*at)[0] - place[0], (*at)[1] - place[1]);
    if (off > min_distance) continue;
    min_distance = off;
    nearest = i;
  }
  return nearest;
}

/// A new lamp in the room, its height before the surface that is seen at a place; empty where none
/// is known.
std::optional<Lamp> before_surface(Lamp lamp, Place place, Extent frame, const LampView& view) {
  constexpr float kNearest = 0.05F;  // meters from the camera
  const float depth = view.depth_at(place, frame);
  if (!(depth > 0)) return {};
  lamp.position = {place[0], place[1], std::max(depth - lamp.position[2], kNearest)};
  if (lamp.kind == Lamp::Kind::directional) move_to(lamp, place, frame);
  return view.in_room(lamp, frame);
}

}  // namespace

std::string wrong_lamps(const GValue* value) { return wrong_text(value, "lamps", read_lamps); }

void LampEditor::mouse(const Log& log, const MouseEvent& event, const LampParams& params) {
  using Kind = MouseEvent::Kind;
  const auto mouse = mouse_place(event);
  if (params.lamp_mode == LampMode::off || !mouse) return;
  const Place place = *mouse;
  Extent frame;
  std::optional<Drag> drag;
  std::optional<LampView> view;
  bool adds_in_room = false;
  {
    const Lock lock(mutex_);
    view = view_;
    adds_in_room = adds_in_room_;
    frame = frame_;
    drag = drag_;
    if (event.kind == Kind::release) drag_.reset();
  }
  if (frame.pixels() == 0 || (event.kind != Kind::press && !drag)) return;
  std::optional<Drag> begun;
  change(log, [&](const std::string& text) -> std::optional<std::string> {
    begun.reset();
    LampList list = lamps_of(text, frame);
    if (event.kind != Kind::press) {
      if (drag->lamp >= list.lamps.size()) return {};  // removed meanwhile
      const Place to{std::clamp(place[0] + drag->off[0], 0.F, static_cast<float>(frame.width)),
                     std::clamp(place[1] + drag->off[1], 0.F, static_cast<float>(frame.height))};
      move_lamp(list.lamps[drag->lamp], list.frame, to, frame, view);
      return text_of(list);
    }
    std::optional<size_t> pressed = lamp_at(list, place, frame, view);
    if (params.lamp_mode == LampMode::remove) {
      if (!pressed) return {};
      list.lamps.erase(list.lamps.begin() + static_cast<long>(*pressed));
      return text_of(list);
    }
    const bool adds = !pressed && params.lamp_mode == LampMode::add;
    if (adds) {
      if (list.lamps.size() == kMaxLamps) {
        const Lock lock(mutex_);
        warnings_.push_back(full(kMaxLamps) + kRemoveOne);
        return {};
      }
      Lamp lamp{.kind = params.lamp_kind,
                .position = {0, 0, params.lamp_height},
                .color = params.lamp_color & 0xffffff,
                .power = params.lamp_power};
      std::optional<Lamp> in_room;
      if (view && adds_in_room) in_room = before_surface(lamp, place, frame, *view);
      if (in_room)
        lamp = *in_room;
      else
        move_to(lamp, scaled(place, frame, list.frame), list.frame);
      pressed = list.lamps.size();
      list.lamps.push_back(lamp);
    }
    if (pressed) {
      const Place at = place_in(list.lamps[*pressed], list.frame, frame, view).value_or(place);
      begun = Drag{*pressed, {at[0] - place[0], at[1] - place[1]}};
    }
    if (!adds) return {};
    return text_of(list);
  });
  if (!begun) return;
  const Lock lock(mutex_);
  drag_ = begun;
}

void LampEditor::add(const Log& log, const std::string& lamp) {
  const Extent size = frame();
  const Lamp added = read_lamp(lamp);
  change(log, [&](const std::string& text) {
    LampList list = lamps_of(text, size);
    if (list.lamps.size() == kMaxLamps) json_list::refuse(full(kMaxLamps) + kRemoveOne);
    list.lamps.push_back(added);
    scale(list.lamps.back(), size, list.frame);
    return text_of(list);
  });
}

void LampEditor::remove(const Log& log, unsigned index) {
  change(log, [&](const std::string& text) {
    LampList list = read_lamps(text);
    erase(list.lamps, index);
    return text_of(list);
  });
  const Lock lock(mutex_);
  if (!drag_ || drag_->lamp + 1 < index) return;
  if (drag_->lamp + 1 == index)
    drag_.reset();
  else
    --drag_->lamp;
}

std::vector<Lamp> LampEditor::take(const std::string& lamps, Extent frame) {
  const Lock lock(mutex_);
  frame_ = frame;
  if (taken_ && taken_->first == lamps && taken_->second == frame) return lamps_;
  LampList list = read_lamps(lamps);
  for (Lamp& lamp : list.lamps) scale(lamp, list.frame, frame);
  lamps_ = std::move(list.lamps);
  taken_.emplace(lamps, frame);
  return lamps_;
}

void LampEditor::see(std::optional<LampView> view, bool adds) {
  const Lock lock(mutex_);
  view_ = std::move(view);
  adds_in_room_ = adds;
}

void LampEditor::flush() {
  const Lock lock(mutex_);
  view_.reset();
}

void LampEditor::stop() {
  flush();
  const Lock lock(mutex_);
  drag_.reset();
}

}  // namespace inverse
