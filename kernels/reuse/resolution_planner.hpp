// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>

namespace inverse {

/// Chooses between full and half resolution for ScaledIntrinsic, and when both are compared. Needs
/// no device: findings come from the caller, as for Planner.
class ResolutionPlanner {
 public:
  struct Params {
    bool adaptive = true;
    size_t halvings = 0;       ///< asked for; above 0 nothing is chosen
    float half_tolerance = 0;  ///< distance of half from full resolution, rms of log shading
  };
  /// What the frame kFramesInFlight before found; distance counts if it was compared.
  struct Found {
    bool cut = false, compared = false;
    float distance = 0;
  };
  struct Choice {
    size_t halvings = 0;
    bool crosses = false;                ///< another resolution than the frame before
    bool compares = false;               ///< solved at the other resolution, too
    bool cut = false;                    ///< found: what fades is of the scene before
    bool half_rejected = false;          ///< half is far from its bound: it will not be used soon
    const char* full_because = nullptr;  ///< why full resolution is solved; null: it is not
    bool operator==(const Choice&) const = default;
  };

  /// Forgets the frames so far, but not their resolution.
  void reset();
  /// Plans the next frame. `found` is empty if no frame that far back was recorded.
  Choice next(const Params& params, const std::optional<Found>& found);
  float half_distance() const { return half_distance_; }

  /// Share of the bound that half resolution has to keep to be chosen; from the bound on it is
  /// left.
  static constexpr float kEnter = 0.8F;
  /// Frames after a reset to the first comparison, and from one to the next: kMaxNext if half
  /// is far from its bound. A cut has one at once, if so many frames have passed since the last
  /// one.
  static constexpr uint64_t kFirst = 24, kNext = 64, kMaxNext = 512, kAgain = 16,
                            kAgainAtFull = 128;

 private:
  bool learn(const Params& params, const Found& found);

  std::optional<size_t> was_;  // halvings of the frame before
  bool fits_ = false;          // half resolution keeps the bound
  uint64_t since_reset_ = 0;   // frames
  uint64_t compare_at_ = kFirst;
  std::optional<uint64_t> compared_at_;
  float half_distance_ = 0;
};

}  // namespace inverse
