// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <optional>

#include "kernels/material/object/crop_change.hpp"
#include "kernels/material/object/object_tracker.hpp"

namespace inverse {

/// Decides which of LimeMaterial's networks run for a frame from the results of earlier frames.
/// Uses neither device nor pixels.
class NetworkSchedule {
 public:
  /// Of LimeMaterial::Params, which documents them.
  struct Params {
    bool adaptive = true;
    uint32_t estimate_interval = 8;
  };
  /// State at a new frame, according to the last finished one.
  struct Known {
    Square square;             ///< square to analyze
    bool unchanged = false;    ///< the pixels in the square are unchanged
    bool found = false;        ///< an object is present
    bool placed = false;       ///< its layers were computed from that same square
    float moved = 1;           ///< share of its points that changed
    bool converged = false;    ///< its material is known
    bool draws = false;        ///< its layers are requested
    bool finds_light = false;  ///< its light is requested and can be estimated
    uint64_t views = 0;        ///< views of the object in the light
    /// Change of its image since its layers were computed; empty: no reference image.
    std::optional<CropChange::Difference> changed;
    /// Change since it came to rest, or since its light began; empty: it moves.
    std::optional<CropChange::Difference> light_changed;
  };
  struct Plan {
    bool static_object = false;   ///< the object rests; it may be analyzed nevertheless
    bool segments = false;        ///< SegmentationNet runs
    bool estimates = false;       ///< the other four do
    bool lights = false;          ///< this view of the object is added to the light
    bool light_restarts = false;  ///< the light begins with this view: earlier ones belong to
                                  ///< another light
    bool compares = false;        ///< its image is stored or compared
    const char* skipped = "";     ///< skipped work and the reason
  };

  /// Discards the history.
  void restart() { *this = {}; }
  Plan next(const Params& params, const Known& known);

  /// Maximum change of any block of a resting object's image for reusing its layers: sRGB, five
  /// code values.
  static constexpr float kChanged = 0.02F;
  /// Maximum mean change for the same purpose, beyond the share that moved: a larger one is a
  /// change of the lamps.
  static constexpr float kRelit = 0.01F;
  /// Maximum number of following estimates whose light is theirs alone.
  static constexpr uint32_t kFollow = 30;
  /// The light changes more slowly than frames arrive, and costs the host 1 to 2 ms: the first
  /// views are all used, then one in this many.
  static constexpr uint64_t kEarlyViews = 4, kViewEvery = 4;

 private:
  std::optional<Square> searched_;  // of the last search
  bool rested_in_place_ = false;    // since its light began, and has not moved since
  uint32_t rested_ = 0;             // frames since its last search
  uint32_t follow_ = 0;             // estimates to come whose light is theirs alone
  uint64_t estimates_ = 0;
};

}  // namespace inverse
