// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gst/base/filter.hpp"
#include "kernels/intrinsic/strokes/stroke_mask.hpp"

namespace inverse {

/// What the mouse does on the picture.
enum class StrokeMode : uint8_t { off, shading, reflectance, erase };

/// The properties about strokes of a decomposer.
struct StrokeParams {
  std::string strokes;  ///< read_strokes
  StrokeMode stroke_mode = StrokeMode::off;
  float stroke_radius = 12;  ///< pixels
  bool stroke_fill = false;
};

/// The strokes of an element's user. The property `strokes` has all of them but the one that is
/// being drawn; whatever changes them sets that property, so that applications see it. Thread-safe.
class StrokeEditor {
 public:
  /// The mouse over the picture. Ignored before the first frame.
  void mouse(const Log& log, const MouseEvent& event, const StrokeParams& params);
  /// What the action signals do; throw Error(unsupported).
  void add(const Log& log, const std::string& stroke);
  void remove(const Log& log, unsigned index);  ///< from 1 on
  void clear(const Log& log);
  void undo(const Log& log);

  /// Whether `take` would return others than the last time. `strokes` is the property.
  bool changed(const std::string& strokes) const;
  /// The strokes for a frame of this size; null if there are none. `mosaic`: the picture that the
  /// mouse moves over shows several layers side by side.
  StrokesPtr take(const std::string& strokes, Extent frame, bool mosaic);
  /// Warnings since the last call.
  std::vector<std::string> take_warnings() {
    const std::lock_guard lock(mutex_);
    return std::exchange(warnings_, {});
  }
  /// Forgets the stroke that is being drawn: its picture is gone.
  void flush();

  /// Checks what a completed frame found of each stroke: adds a warning, once, for one that could
  /// not be satisfied.
  void check(const StrokesPtr& list, const std::vector<float>& rms);

 private:
  using Lock = std::lock_guard<std::mutex>;
  void set(const Log& log, const StrokeList& list);
  void extend(Stroke::Point point);

  mutable std::mutex mutex_;
  Extent frame_{};
  bool mosaic_ = false;
  std::optional<Stroke> drawing_;
  bool drawing_changed_ = false;
  std::string taken_;  // the property
  StrokesPtr list_;
  std::vector<std::string> undo_;  // the property before each change
  std::vector<std::string> warnings_;
  StrokesPtr checked_;
  unsigned checked_frames_ = 0;
};

/// The action signals add-stroke, remove-stroke, clear-strokes and undo-stroke of a decomposer
/// whose method has DecompositionMethod::strokes.
std::vector<Action> stroke_actions();

}  // namespace inverse
