// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gst/base/json/list_editor.hpp"
#include "kernels/edit/relight/lamps.hpp"
#include "lamp_view.hpp"

namespace inverse {

/// What the mouse does on the picture.
enum class LampMode : uint8_t { off, move, add, remove };

/// The properties of an element about lamps.
struct LampParams {
  std::string lamps;  ///< read_lamps
  LampMode lamp_mode = LampMode::move;
  /// Of lamps that the mouse adds.
  Lamp::Kind lamp_kind = Lamp::Kind::point;
  uint32_t lamp_color = 0xffffffff;  ///< 0xAARRGGBB
  float lamp_power = 0.05F, lamp_height = 0.25F;
};

/// What is wrong with a value of the property `lamps`, in words.
std::string wrong_lamps(const GValue* value);

/// The lamps of an element's user, which the property `lamps` has.
class LampEditor : public ListEditor {
 public:
  LampEditor() : ListEditor("lamp", "lamps", 0) {}
  /// The mouse over the picture. Ignored before the first frame.
  void mouse(const Log& log, const MouseEvent& event, const LampParams& params);
  /// What the action signals do; throw Error(unsupported).
  void add(const Log& log, const std::string& lamp);
  void remove(const Log& log, unsigned index);  ///< from 1 on

  /// What a completed frame saw of a remembered scene; empty: nothing. Lamps in the room follow the
  /// mouse in it, and with `adds` new ones stand in it.
  void see(std::optional<LampView> view, bool adds);
  /// The lamps of the property for a frame of this size, in its pixels.
  std::vector<Lamp> take(const std::string& lamps, Extent frame);
  /// Forgets what a frame saw. A drag goes on: a picture that stands is asked for again after each
  /// step of it.
  void flush();
  /// Ends a drag as well: no frame comes any more.
  void stop();

 private:
  struct Drag {
    size_t lamp;
    Place off;  ///< from the mouse to the lamp, pixels
  };

  std::optional<Drag> drag_;
  std::optional<LampView> view_;
  bool adds_in_room_ = false;
  std::optional<std::pair<std::string, Extent>> taken_;
  std::vector<Lamp> lamps_;  // of taken_
};

}  // namespace inverse
