// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace inverse {

/// Plans how GlobalIntrinsic finds the color of a frame's light. Needs no device.
class LightPlanner {
 public:
  enum class Light : uint8_t {
    measure,       ///< measured
    measure_keep,  ///< measured, and kept for the next frames
    reuse,         ///< that of the frame before
  };
  struct Plan {
    Light light = Light::measure;
    bool gray = false;  ///< light counts as white; only whether color comes back is measured
    /// As in Plan of plan.hpp.
    std::vector<std::string> skipped, run;
    bool reused() const { return light == Light::reuse; }
  };
  struct Frame {
    bool adaptive = true;
    bool first = false;        ///< since the start or a reset
    bool same_params = false;  ///< light is found as in the frame before
    /// The frame kFramesInFlight before had color to find light by. Empty if there is none so far
    /// back, or if parameters ask for light anyway.
    std::optional<bool> had_color;
    bool light_asked = false;  ///< by parameters, whatever the colors are
    bool repeated = false;     ///< the picture is that of the frame before
  };

  Plan next(const Frame& frame);
  void reset() { repeats_ = gray_frames_ = 0; }

  /// Frames in a row without color after which only that is measured.
  static constexpr uint32_t kGrayFrames = 8;
  /// Repeats of a picture after which its light is reused.
  static constexpr uint32_t kRepeats = 12;

 private:
  bool gray(const Frame& frame);
  /// Returns why light is measured; null if it is reused.
  const char* reason_to_measure(const Frame& frame);

  uint32_t gray_frames_ = 0, repeats_ = 0;  // in a row
};

}  // namespace inverse
