// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tolerances.hpp"

namespace inverse {

/// What of a frame of IntrinsicDecomposition is run, and what is skipped. A plain value: stages
/// obey it.
struct Plan {
  /// What is done about the weights of edges.
  enum class Edges : uint8_t {
    all,       ///< evaluated
    all_save,  ///< evaluated, and saved for the next frame to compare with
    compare,   ///< evaluated in tiles that changed, reused in others
  };
  Edges edges = Edges::all;
  bool history = false;          ///< the frame before is part of the energy
  uint32_t cycles = 0;           ///< of the multigrid, at most
  float cycle_tolerance = 0;     ///< no cycle follows one that changes less; 0: all run
  bool compares_pixels = false;  ///< with those of the frame before
  bool bins = true;              ///< the chroma bins are part of the energy
  bool measures_bins = false, measures_gate = false;
  /// What is skipped, and what is run although it might be skipped: "stage: reason".
  std::vector<std::string> skipped, run;

  bool stops() const { return cycle_tolerance > 0; }  ///< cycles end if they change little
  bool operator==(const Plan&) const = default;
};

/// Plans every frame of IntrinsicDecomposition by what frames before it found, and when to measure
/// again what was skipped. Needs neither device nor pixels: findings come from the caller, of the
/// last frame that is sure to be done, so that the same video always gets the same plans.
class Planner {
 public:
  /// Of IntrinsicDecomposition::Params, where each is explained.
  struct Params {
    bool adaptive = true, chroma = true, anchor = true;  ///< chroma, anchor: have a weight
    Tolerances tolerances;
    uint32_t cycles = 4, warm_cycles = 2;
  };
  /// What is known of a frame before anything of it is recorded.
  struct Frame {
    bool history = false;     ///< there is a frame before, and it is compared with that
    bool warm_start = false;  ///< the one before is of another resolution
    bool repeated = false;    ///< the picture is that of the frame before
  };
  /// What the frame kFramesInFlight before it found.
  struct Found {
    Plan plan;
    uint32_t cycles = 0;                      ///< that ran
    float change = 0;                         ///< of log shading by the last cycle, rms
    bool cut = false;                         ///< a scene cut: nothing of the frame before was used
    uint32_t tiles = 0, tiles_evaluated = 0;  ///< all, and those whose edges were evaluated
    float binding = 0;  ///< with Plan::measures_bins: effect of the chroma bins, rms log shading
    float gate = 0;     ///< with Plan::measures_gate: the anchor's gate, rms over cells
  };

  /// The next frame is the first one of its kind: without a past, or with other parameters.
  void restart() { since_restart_ = 0; }
  /// Plans the next frame. `found` is empty if no frame that far back was recorded.
  Plan next(const Params& params, const Frame& frame, const std::optional<Found>& found);

  /// Frames from one measurement of bins and gate to the next, if something is skipped and if not.
  static constexpr uint64_t kMeasureSoon = 4, kMeasureEvery = 16;
  /// Frames from one comparison of tiles to the next if edges of most tiles are evaluated:
  /// comparing then costs more than it saves.
  static constexpr uint64_t kCompareEvery = 8;

 private:
  void learn(const Params& params, const Found& found);
  /// Whether cycles are likely to end early, so that measuring their change is worth it.
  bool may_stop(float tolerance, const std::optional<Found>& found) const;
  bool old_enough() const;

  uint64_t since_restart_ = 0;  // frames
  bool bins_matter_ = true, gate_matters_ = true, many_edges_change_ = false;
};

}  // namespace inverse
