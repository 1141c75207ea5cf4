// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "gst/base/json/list_editor.hpp"
#include "kernels/camera/place_stroke.hpp"
#include "kernels/image/strokes/stroke_tracker.hpp"
#include "touch_watch.hpp"

namespace inverse {

/// What the mouse does on the picture, and a touch in the scene.
enum class StrokeMode : uint8_t { off, shading, reflectance, recolor, erase, select, pick };

/// The properties about strokes of a decomposer.
struct StrokeParams {
  std::string strokes;  ///< read_strokes
  StrokeMode stroke_mode = StrokeMode::off;
  float stroke_radius = 12;  ///< pixels
  bool stroke_fill = false;
  uint32_t stroke_color = 0xff2864c8;  ///< sRGB, of those that recolor
  bool stroke_follow = true;
  bool stroke_touch = false;
};

/// The strokes for a frame. Lists stay the same object while their strokes do; null: there are
/// none.
struct StrokeLists {
  StrokesPtr all;
  StrokesPtr solved, recolored, selected;  ///< of `all`: the kinds that the method solves with,
                                           ///< and the others
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
  StrokeEditor() : ListEditor("stroke", "strokes::list") {}
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
  /// Adds strokes that a scene from a file has, but not those that the list has already.
  void add_loaded(const Log& log, const std::vector<Stroke>& strokes);
  /// Forgets what was seen of a scene.
  void forget_scene();

  /// Whether some strokes of a list are yet to be put into a remembered scene.
  static bool places(const StrokeList& list);
  /// A completed frame with this list saw this of the scene: puts those strokes into it that have
  /// surfaces under them, and sets the property. `places`: where the others are in that frame;
  /// empty if they are as drawn.
  void see(const Log& log, const StrokeList& list, const std::vector<StrokePlace>& places,
           const SceneView& view);

  /// A completed frame, which saw this of the scene, touches that: draws as the mouse would.
  void touch(const Log& log, const std::optional<Touch>& touch,
             const std::optional<SceneView>& view, const StrokeParams& params);
  /// The place that the mouse has pressed in StrokeMode::pick since the last call.
  std::optional<Stroke::Point> take_pick();
  /// Strokes that recolor get this reflectance, linear RGB, and are drawn from now on.
  static void pick(const Log& log, const std::array<float, 3>& color);
  /// Element messages about touches since the last call.
  std::vector<StructurePtr> take_messages();

  /// Checks what a completed frame found of each stroke of its list: adds a warning, once, for one
  /// that could not be satisfied or was lost. `places`: empty if they are not followed.
  void check(const StrokesPtr& list, const std::vector<float>& rms,
             std::vector<StrokePlace> places);

 private:
  /// Whether a stroke of a list for frames of size `drawn` is now seen at a point of the frame.
  bool covers_now(const Stroke& stroke, Extent drawn, Stroke::Point point) const;
  /// Adds a finished stroke, or a warning if there are too many.
  void finish(const Log& log, const Stroke& stroke, Extent frame);
  /// Removes the last stroke that is seen at a point of the frame.
  void erase_at(const Log& log, Stroke::Point point, Extent frame);

  bool mosaic_ = false;
  std::optional<Stroke> drawing_;
  std::optional<Stroke> touched_;  // the stroke that a touch draws
  TouchWatch watch_;
  std::vector<StructurePtr> messages_;
  std::optional<Stroke::Point> picked_;
  bool drawing_changed_ = false;  // either of those
  std::string taken_;             // the property
  StrokeLists lists_;
  StrokesPtr checked_;
  unsigned checked_frames_ = 0;
  std::vector<StrokePlace> places_;  // of `checked_`
  std::optional<SceneView> view_;    // without depth
  bool lost_ = false;                // some of those, and a warning said so
};

}  // namespace inverse
