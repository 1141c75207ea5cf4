// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace inverse {

/// Plans how GlobalIntrinsic finds the color of a frame's light. Needs no device.
class LightPlanner {
 public:
  enum class Light : uint8_t {
    measure,       ///< measured
    measure_keep,  ///< measured, and kept for the next frames
    reuse,         ///< that of the frame before, but for tiles that changed
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
    /// Of every tile of 16 x 16 pixels, row by row, 0 if its input is that of the frame before;
    /// empty if that is not known.
    std::span<const uint8_t> changed;
    uint32_t columns = 0;  ///< tiles in a row
  };

  Plan next(const Frame& frame);
  void reset() { static_frames_ = gray_frames_ = 0; }
  /// Of the last frame: the tiles that changed and those beside them, whose chroma is interpolated
  /// from them.
  const std::vector<uint8_t>& tiles() const { return tiles_; }

  /// Frames in a row without color after which only that is measured.
  static constexpr uint32_t kGrayFrames = 8;
  /// Frames in a row, each with at most kMaxChangedTiles, after which light is reused.
  static constexpr uint32_t kStaticFrames = 12;
  /// Frames for which light is reused, and the share of tiles that may change in that time. Then it
  /// is measured for some frames.
  static constexpr uint32_t kReuseFrames = 64, kMeasureFrames = 4;
  static constexpr float kMaxEverChanged = 0.4F;

 private:
  bool gray(const Frame& frame);
  /// Returns why light is measured; null if it is reused.
  const char* reason_to_measure(const Frame& frame);

  uint32_t gray_frames_ = 0, static_frames_ = 0;  // in a row
  std::vector<uint8_t> tiles_;
  std::vector<uint8_t> ever_changed_;  // tiles, since light was measured
};

}  // namespace inverse
