// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "kernels/image/pyramid.hpp"
#include "kernels/thesis/chapter5/global_thesis.hpp"
#include "kernels/thesis/chapter5/regions/marked_regions.hpp"
#include "kernels/thesis_chapter5_correction_regions_reduce.spv.hpp"
#include "kernels/thesis_chapter5_correction_regions_try.spv.hpp"

namespace inverse {

/// Finds the base colors of marked regions (thesis, 5.5.2.2): decomposes a frame with every
/// candidate, measures how sparse the region's indirect light is (5.11), and gives the region the
/// color with the sparsest. The region's own cluster is no candidate: it explains the region as
/// paint in white light, without any indirect light, and would always be the sparsest.
///
/// One candidate a frame, beside a live stream. Candidates are decomposed at a quarter of the
/// frame's width, which adds about a sixteenth to the time of a frame; at half the width (a quarter
/// more) for regions of fewer than 1024 pixels; and at full size (twice the time) for regions of
/// fewer than 256 pixels or that vanish at a smaller size.
class MisclusteringCorrection {
 public:
  struct Result {
    int number;   ///< of the region
    int cluster;  ///< slot that its pixels were assigned to
    int color;    ///< slot given to it
    /// Mean Σ_k |T_k| of its pixels for each slot tried.
    std::vector<std::pair<int, float>> scores;
  };

  /// Throws Error(limit, out_of_memory).
  MisclusteringCorrection(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Makes the kernels that the correction of a video decomposed by `method` may need.
  void make_kernels(const GlobalThesis& method) const;

  /// Records the decomposition of a candidate if a region has no color. Call it after `method` has
  /// recorded a frame with `regions`. Returns a number for `collect`.
  uint64_t record(gpu::Commands& commands, const GlobalThesis& method,
                  const MarkedRegions& regions);
  /// Reads the results of one of the last three frames. Wait for its Commands first. After a
  /// region's last candidate, gives the region its color and returns the result.
  std::optional<Result> collect(uint64_t frame, MarkedRegions& regions);

  /// Discards all pending work, for a flush, a discontinuity or a scene cut.
  void reset();
  bool busy() const { return job_.has_value(); }
  /// Regions without any candidate, found since the last call.
  std::vector<int> take_hopeless() { return std::exchange(reported_hopeless_, {}); }

 private:
  static constexpr int kMaxHalvings = 2;
  static constexpr uint32_t kMinPixels = 64;    ///< of a region in the smaller frame
  using RegionName = std::pair<int, uint64_t>;  ///< number, since
  /// A frame size, half the one before.
  struct Level {
    Extent extent;
    Plane image, regions, trial;
    std::unique_ptr<GlobalThesis> method;
  };
  struct Job {
    MarkedRegions::Region region;
    size_t level;
    std::vector<int> candidates;  ///< not recorded yet, the next one last
    size_t wanted;                ///< scores
    std::vector<std::pair<int, float>> scores;
  };
  struct Frame {
    bool pending = false;
    uint32_t job = 0;  ///< which one, counted
    uint64_t number = 0;
    int candidate = 0;
  };

  Level& level(size_t index);
  void begin(gpu::Commands& commands, const GlobalThesis& method, const MarkedRegions& regions);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  Halve halve_;
  gpu::Program<shaders::thesis_chapter5_correction_regions_reduce> reduce_;
  gpu::Program<shaders::thesis_chapter5_correction_regions_try> try_;
  std::array<Level, kMaxHalvings + 1> levels_;
  std::optional<Job> job_;
  uint32_t jobs_ = 0;
  std::vector<RegionName> hopeless_;    ///< regions without candidates
  std::vector<int> reported_hopeless_;  ///< not taken yet
  std::vector<RegionName> thin_;        ///< without pixels in a smaller frame
  gpu::FrameRing<Frame> frames_;
  uint64_t recorded_ = 0;
};

}  // namespace inverse
