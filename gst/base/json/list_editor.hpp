// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "gst/base/filter.hpp"
#include "json_list.hpp"
#include "kernels/image/place.hpp"
#include "text_property.hpp"

namespace inverse {

/// Edits a property that is a list in JSON (json_list.hpp). Whatever changes the list sets the
/// property, so that applications see it. Thread-safe.
class ListEditor {
 public:
  /// What the action signals do; throw Error(unsupported).
  void clear(const Log& log);
  void undo(const Log& log);
  /// Warnings since the last call.
  std::vector<std::string> take_warnings();

 protected:
  using Lock = std::lock_guard<std::mutex>;
  static constexpr size_t kMaxUndo = 100;
  /// `entry`: what an entry is called. So many changes can be undone.
  ListEditor(const char* entry, const char* property, size_t max_undo = kMaxUndo)
      : entry_(entry), property_(property), max_undo_(max_undo) {}

  /// Changes the list, in one step with reading it. `changed` returns the text that takes the place
  /// of one, or nothing to leave it, and is called again if an application has set the property
  /// meanwhile. mutex_ not held.
  using Changed = std::function<std::optional<std::string>(const std::string& text)>;
  void change(const Log& log, const Changed& changed);
  /// Rewrites the list as it is and as undoing would make it; this cannot be undone. `rewritten`
  /// returns the text that takes the place of one. mutex_ not held.
  using Rewritten = std::function<std::string(const std::string& text)>;
  void amend(const Log& log, const Rewritten& rewritten);
  Extent frame() const;
  /// That a list has as many entries as it may.
  std::string full(size_t max) const;
  /// Removes entry `index`, from 1 on. Throws Error(unsupported).
  template <typename Entry>
  void erase(std::vector<Entry>& entries, unsigned index) const {
    if (index < 1 || index > entries.size())
      json_list::refuse("there is no " + entry_ + " " + std::to_string(index) + "; there are " +
                        std::to_string(entries.size()));
    entries.erase(entries.begin() + (index - 1));
  }
  /// Where the mouse is, within kMaxCoordinate; none if that is no number.
  static std::optional<Place> mouse_place(const MouseEvent& event);
  /// Extends a line that is drawn to a place, if that is a quarter of the radius away from its end.
  /// Adds a warning, once for a line, if it has kMaxPoints: its end moves. Returns whether it
  /// changed. mutex_ held.
  bool extend(std::vector<Place>& line, Place to, float radius);

  mutable std::mutex mutex_;
  Extent frame_{};  // that the mouse is over; empty before the first one
  std::vector<std::string> warnings_;

 private:
  /// Gives the property what `changed` returns, and returns what it was before; empty if it is to
  /// be left. edits_ held; the caller notifies without it.
  std::optional<std::string> replace(const Log& log, const Changed& changed) const;
  void notify(const Log& log) const;

  const std::string entry_, property_;
  const size_t max_undo_;
  std::mutex edits_;               // of the property and undo_; mutex_ may be locked within it
  std::vector<std::string> undo_;  // the property before each change
  bool long_ = false;              // the line that is drawn, and a warning said so
};

/// Places in pixels of `from` become those of `to`.
inline void scale(std::vector<Place>& places, Extent from, Extent to) {
  for (Place& place : places) place = scaled(place, from, to);
}

/// Warnings about strokes without effect, by their places in a list: outside of the frame, or under
/// later ones; `kinds` are those that contradict each other. Empty for none.
std::string outside_of(const std::vector<size_t>& strokes, Extent frame);
std::string under_others(const std::vector<size_t>& strokes, const std::string& kinds);

/// The action signal `name`. It calls a member function of the editor that `editor_of` gives for a
/// filter: f(log), f(log, text) or f(log, number).
template <auto editor_of, auto member>
Action edit_action(const char* name) {
  using Editor = std::invoke_result_t<decltype(editor_of), Filter&>;
  constexpr bool kText =
      std::is_invocable_v<decltype(member), Editor, const Log&, const std::string&>;
  constexpr bool kNumber = std::is_invocable_v<decltype(member), Editor, const Log&, unsigned>;
  std::vector<GType> arguments;
  if constexpr (kText || kNumber) arguments.push_back(kText ? G_TYPE_STRING : G_TYPE_UINT);
  const auto run = [](Filter& filter, [[maybe_unused]] const GValue* argument) {
    Editor editor = editor_of(filter);
    if constexpr (kText) {
      const char* text = g_value_get_string(argument);
      (editor.*member)(filter.log(), text ? text : "");
    } else if constexpr (kNumber) {
      (editor.*member)(filter.log(), g_value_get_uint(argument));
    } else {
      (editor.*member)(filter.log());
    }
  };
  return {name, std::move(arguments), run, true};
}

}  // namespace inverse
