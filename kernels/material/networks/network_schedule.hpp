#pragma once
#include <cstdint>
#include <optional>

#include "kernels/material/object/crop_change.hpp"
#include "kernels/material/object/object_tracker.hpp"

namespace inverse {

/// Decides which of LimeMaterial's networks run for a frame, by what frames before it found. Knows
/// neither device nor pixels.
class NetworkSchedule {
 public:
  /// Of LimeMaterial::Params, where each is explained.
  struct Params {
    bool adaptive = true;
    uint32_t recheck = 8;
  };
  /// What is known when a frame comes, by the last one that is done.
  struct Known {
    Square square;             ///< the frame is looked at in
    bool still = false;        ///< pixel by pixel it is the one before, there
    bool found = false;        ///< there is an object
    bool placed = false;       ///< and its layers, from a look at that very square
    float moved = 1;           ///< share of its points
    bool steady = false;       ///< its material is known
    bool draws = false;        ///< its layers are asked for
    bool finds_light = false;  ///< its light is, and can be told
    uint64_t views = 0;        ///< of it that are in the light
    /// Its picture, since it had those layers; none: nobody has kept that picture.
    std::optional<CropChange::Difference> changed;
    /// The same since it rests, or its light began; none: it moves.
    std::optional<CropChange::Difference> relit;
  };
  struct Plan {
    bool rests = false;        ///< the object does; it may be looked at all the same
    bool segments = false;     ///< SegmentationNet runs
    bool estimates = false;    ///< the other four do
    bool lights = false;       ///< that view of the object goes into the light
    bool light_anew = false;   ///< which begins with it: those before are of another light
    bool compares = false;     ///< its picture is kept or compared
    const char* skipped = "";  ///< what is left out, and why
  };

  /// The next frame has no past.
  void restart() { *this = {}; }
  Plan next(const Params& params, const Known& known);

  /// Layers of a resting object are of an earlier frame while no part of its picture differs by
  /// more: sRGB, five code values.
  static constexpr float kChanged = 0.02F;
  /// The same in the mean, of any time since it rests, beyond what of the object has moved: its
  /// lamps changed, not it.
  static constexpr float kRelit = 0.01F;
  /// Estimates after that whose light is theirs alone, at most.
  static constexpr uint32_t kFollow = 30;
  /// The light changes slower than frames come, and costs the host 1 to 2 ms: of the first views
  /// each is taken, then one in so many.
  static constexpr uint64_t kEarlyViews = 4, kViewEvery = 4;

 private:
  std::optional<Square> searched_;  // where the last look was
  bool rested_in_place_ = false;    // since its light began, and has not moved since
  uint32_t rested_ = 0;             // frames since it was looked at last
  uint32_t follow_ = 0;             // estimates to come whose light is theirs alone
  uint64_t estimates_ = 0;
};

}  // namespace inverse
