// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "gst/base/json/list_editor.hpp"
#include "kernels/image/strokes/stroke_tracker.hpp"
#include "kernels/volume/strokes/place_stroke.hpp"

namespace inverse {

/// What the mouse does on the picture.
enum class StrokeMode : uint8_t { off, shading, reflectance, recolor, erase };

/// The properties about strokes of a decomposer.
struct StrokeParams {
  std::string strokes;  ///< read_strokes
  StrokeMode stroke_mode = StrokeMode::off;
  float stroke_radius = 12;  ///< pixels
  bool stroke_fill = false;
  uint32_t stroke_color = 0xff2864c8;  ///< sRGB, of those that recolor
  bool stroke_follow = true;
};

/// The strokes for a frame. Lists stay the same object while their strokes do; null: there are
/// none.
struct StrokeLists {
  StrokesPtr all;
  StrokesPtr solved, recolored;  ///< of `all`, the kinds that the method solves with, and the other
};

/// Where a stroke is now.
struct StrokePlace {
  StrokeTracker::Pose pose;
  Stroke::Point center{};
};

/// The strokes of an element's user. The property `strokes` has all of them but the one that is
/// being drawn.
class StrokeEditor : public ListEditor {
 public:
  StrokeEditor() : ListEditor("stroke") {}
  /// The mouse over the picture. Ignored before the first frame.
  void mouse(const Log& log, const MouseEvent& event, const StrokeParams& params);
  /// What the action signals do; throw Error(unsupported).
  void add(const Log& log, const std::string& stroke);
  void remove(const Log& log, unsigned index);  ///< from 1 on

  /// Whether `take` would return others than the last time. `strokes` is the property.
  bool changed(const std::string& strokes) const;
  /// The strokes for a frame of this size. `mosaic`: the picture that the
  /// mouse moves over shows several layers side by side.
  StrokeLists take(const std::string& strokes, Extent frame, bool mosaic);
  /// Forgets the stroke that is being drawn: its picture is gone.
  void flush();
  /// Forgets what was seen of a scene.
  void forget_scene();

  /// Whether some strokes of a list are yet to be put into a remembered scene.
  static bool places(const StrokeList& list);
  /// A completed frame with this list saw this of the scene: puts those strokes into it that have
  /// surfaces under them, and sets the property. `places`: where the others are in that frame;
  /// empty if they are as drawn.
  void see(const Log& log, const StrokeList& list, const std::vector<StrokePlace>& places,
           const SceneView& view);

  /// Checks what a completed frame found of each stroke of its list: adds a warning, once, for one
  /// that could not be satisfied or was lost. `places`: empty if they are not followed.
  void check(const StrokesPtr& list, const std::vector<float>& rms,
             std::vector<StrokePlace> places);

 private:
  /// Whether a stroke of a list for frames of size `drawn` is now seen at a point of the frame.
  bool covers_now(const Stroke& stroke, Extent drawn, Stroke::Point point) const;

  bool mosaic_ = false;
  std::optional<Stroke> drawing_;
  bool drawing_changed_ = false;
  std::string taken_;  // the property
  StrokeLists lists_;
  StrokesPtr checked_;
  unsigned checked_frames_ = 0;
  std::vector<StrokePlace> places_;  // of `checked_`
  std::optional<SceneView> view_;    // without depth
  bool lost_ = false;                // some of those, and a warning said so
};

/// The action signals add-stroke, remove-stroke, clear-strokes and undo-stroke of a decomposer
/// whose method has DecompositionMethod::strokes.
std::vector<Action> stroke_actions();

}  // namespace inverse
