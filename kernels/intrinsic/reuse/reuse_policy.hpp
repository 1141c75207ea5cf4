// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <optional>

namespace inverse {

/// Decides what of every frame IntrinsicDecomposition leaves out, by what frames before it found,
/// and when to look again at what was left out. Knows neither device nor pixels: what was found
/// comes from the caller, of the last frame that is sure to be done, so that the same video always
/// gets the same plans.
class ReusePolicy {
 public:
  /// What is done with a frame.
  enum class Mode : uint8_t {
    whole,    ///< everything
    watched,  ///< everything, and a look at which tiles still move: few have changed
    listed,   ///< tiles that need work, alone
  };
  /// Of IntrinsicDecomposition::Params, where each is explained.
  struct Params {
    bool adaptive = true, chroma = true;  ///< chroma: the bins have a weight
    float settled = 0, still_tolerance = 0, chroma_tolerance = 0, hold_tolerance = 0,
          tile_tolerance = 0, cut_fraction = 1;
  };
  /// What is known of a frame before anything of it is recorded.
  struct Frame {
    bool history = false;      ///< it is compared with the one before
    bool taken = false;        ///< that one is of another resolution
    bool layers_kept = false;  ///< the layers of the one before are still there
    float changed = 1;         ///< share of tiles, those beside changed ones included; 1: not known
  };
  /// What the frame kFramesInFlight before it found. Each number only counts where it was looked
  /// for.
  struct Found {
    uint32_t cycles = 0, cycles_recorded = 0;  ///< that ran, of so many
    float change = 0;                          ///< of log shading by the last cycle, rms
    bool history = false, cut = false;
    bool compared_edges = false, looked_at_bins = false, looked_at_gate = false;
    uint32_t tiles = 0, tiles_evaluated = 0;  ///< with compared_edges
    float binding = 0, gate = 0;              ///< with looked_at_…
    uint32_t tiles_busy = 0;  ///< watched or listed: moved by more than tile_tolerance
    float drift = 0;          ///< of its statistics from those that edges were decided on
  };
  struct Plan {
    Mode mode = Mode::whole;
    bool all_tiles = false;                            ///< listed: this time all of them
    bool stops = false;                                ///< cycles end where they change little
    bool compares_edges = false, keeps_edges = false;  ///< keeps: what the next frame compares with
    bool holds = false;                                ///< pixels are compared with those before
    bool bins = true;                                  ///< the chroma bins are part of the energy
    bool looks_at_bins = false, looks_at_gate = false;
  };

  /// The next frame is the first one of its kind: without a past, or with other parameters.
  void restart() { since_restart_ = 0; }
  /// Plans the next frame. `found` is empty where no frame that far back was recorded.
  Plan next(const Params& params, const Frame& frame, const std::optional<Found>& found);

  /// Frames from one look at bins and anchor to the next, where something is left out and where
  /// not.
  static constexpr uint64_t kLookAgain = 4, kLookEvery = 16;
  /// Where edges of most tiles are decided anew, comparing tiles costs more than it saves: frames
  /// from one comparison to the next.
  static constexpr uint64_t kCompareEvery = 8;
  /// Share of tiles from which on a list of them saves nothing worth its trouble: where input has
  /// changed, and of all that need work.
  static constexpr float kMostChanged = 0.25F, kMostBusy = 0.5F;
  /// Listed frames from one that works on all tiles to the next.
  static constexpr uint64_t kAllEvery = 32;

 private:
  void judge(const Params& params, const Found& found);
  bool may_settle(const Params& params, const std::optional<Found>& found) const;
  void choose_mode(Plan& plan, const Params& params, const Frame& frame,
                   const std::optional<Found>& found);
  bool old_enough() const;

  uint64_t since_restart_ = 0;                           // frames
  bool binds_ = true, holds_ = true, restless_ = false;  // what `judge` has found
  uint64_t calm_ = 0;    // frames in a row that were not worked on as a whole without a look
  uint64_t listed_ = 0;  // listed frames since the last whole or watched one
  Plan before_;
};

}  // namespace inverse
