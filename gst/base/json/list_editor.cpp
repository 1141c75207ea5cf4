// SPDX-License-Identifier: LGPL-2.1-or-later
#include "list_editor.hpp"

#include <algorithm>
#include <cmath>

namespace inverse {
namespace {

/// "stroke 1", or "strokes 1, 2".
std::string numbers_of(const std::vector<size_t>& strokes) {
  std::string text = strokes.size() > 1 ? "strokes" : "stroke";
  for (size_t i = 0; i < strokes.size(); ++i)
    text += (i > 0 ? ", " : " ") + std::to_string(strokes[i] + 1);
  return text;
}

}  // namespace

std::string outside_of(const std::vector<size_t>& strokes, Extent frame) {
  if (strokes.empty()) return {};
  return numbers_of(strokes) + ": without effect outside of the frame of " +
         std::to_string(frame.width) + "x" + std::to_string(frame.height) +
         " pixels; draw inside of it, or remove what is outside";
}

std::string under_others(const std::vector<size_t>& strokes, const std::string& kinds) {
  if (strokes.empty()) return {};
  return numbers_of(strokes) + ": without effect, as later strokes of the other kind (" + kinds +
         ") cover all of it; remove one of the two";
}

std::optional<std::string> ListEditor::replace(const Log& log, const Changed& changed) const {
  PropertyStore& store = filter_of(log.object).parameters();
  for (;;) {
    std::string before = text_property(log, property_.c_str());
    const std::optional<std::string> after = changed(before);
    if (!after) return {};
    if (store.exchange(property_, before, *after)) return before;
  }
}

void ListEditor::notify(const Log& log) const {
  GObject* owner = nullptr;
  GParamSpec* spec = nullptr;
  if (!gst_child_proxy_lookup(GST_CHILD_PROXY(log.object), property_.c_str(), &owner, &spec))
    return;
  g_object_notify_by_pspec(owner, spec);
  g_object_unref(owner);
}

void ListEditor::change(const Log& log, const Changed& changed) {
  {
    const Lock lock(edits_);
    std::optional<std::string> before = replace(log, changed);
    if (!before) return;
    undo_.push_back(std::move(*before));
    if (undo_.size() > max_undo_) undo_.erase(undo_.begin());
  }
  notify(log);
}

void ListEditor::amend(const Log& log, const Rewritten& rewritten) {
  {
    const Lock lock(edits_);
    for (std::string& before : undo_) before = rewritten(before);
    replace(log, rewritten);
  }
  notify(log);
}

void ListEditor::clear(const Log& log) {
  change(log, [](const std::string&) { return std::string(); });
}

void ListEditor::undo(const Log& log) {
  {
    const Lock lock(edits_);
    if (undo_.empty()) json_list::refuse("no change of the " + entry_ + "s is left to undo");
    replace(log, [this](const std::string&) { return undo_.back(); });
    undo_.pop_back();
  }
  notify(log);
}

std::vector<std::string> ListEditor::take_warnings() {
  const Lock lock(mutex_);
  return std::exchange(warnings_, {});
}

Extent ListEditor::frame() const {
  const Lock lock(mutex_);
  return frame_;
}

std::string ListEditor::full(size_t max) const {
  return "there are " + std::to_string(max) + " " + entry_ + "s already";
}

std::optional<Place> ListEditor::mouse_place(const MouseEvent& event) {
  if (!std::isfinite(event.x) || !std::isfinite(event.y)) return {};
  constexpr double kFar{json_list::kMaxCoordinate};
  return Place{static_cast<float>(std::clamp(event.x, -kFar, kFar)),
               static_cast<float>(std::clamp(event.y, -kFar, kFar))};
}

bool ListEditor::extend(std::vector<Place>& line, Place to, float radius) {
  if (std::hypot(to[0] - line.back()[0], to[1] - line.back()[1]) < std::max(radius / 4, 1.0F))
    return false;
  const bool full = line.size() == json_list::kMaxPoints;
  if (full && !long_)
    warnings_.push_back("the " + entry_ + " has " + std::to_string(json_list::kMaxPoints) +
                        " points, and only its end moves from now on; draw another one");
  long_ = full;
  if (full) line.pop_back();
  line.push_back(to);
  return true;
}

}  // namespace inverse
