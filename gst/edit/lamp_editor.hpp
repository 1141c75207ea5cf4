// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gst/base/filter.hpp"
#include "kernels/edit/relight/lamps.hpp"

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
  float lamp_power = 0.1F, lamp_height = 0.25F;
};

/// What is wrong with a value of the property `lamps`, in words.
std::string wrong_lamps(const GValue* value);

/// The lamps of an element's user. The property `lamps` has all of them; whatever changes them sets
/// that property, so that applications see it. Thread-safe.
class LampEditor {
 public:
  /// The mouse over the picture. Ignored before the first frame.
  void mouse(const Log& log, const MouseEvent& event, const LampParams& params);
  /// What the action signals do; throw Error(unsupported).
  void add(const Log& log, const std::string& lamp);
  void remove(const Log& log, unsigned index);  ///< from 1 on
  void clear(const Log& log);

  /// The lamps of the property for a frame of this size, in its pixels.
  std::vector<Lamp> take(const std::string& lamps, Extent frame);
  /// Warnings since the last call.
  std::vector<std::string> take_warnings() {
    const std::lock_guard lock(mutex_);
    return std::exchange(warnings_, {});
  }
  /// Ends a drag: its picture is gone.
  void flush();

 private:
  using Lock = std::lock_guard<std::mutex>;
  struct Drag {
    size_t lamp;
    Place off;  ///< from the mouse to the lamp, pixels
  };

  mutable std::mutex mutex_;
  Extent frame_{};
  std::optional<Drag> drag_;
  std::optional<std::pair<std::string, Extent>> taken_;
  std::vector<Lamp> lamps_;  // of taken_
  std::vector<std::string> warnings_;
};

}  // namespace inverse
