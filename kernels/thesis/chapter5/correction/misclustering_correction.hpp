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

/// Finds the base colors of marked regions (thesis, 5.5.2.2): decomposes a frame once for every
/// candidate, measures how sparse the region's indirect light comes out (5.11), and gives the
/// region the color with the sparsest. The color that the region was taken for is no candidate: it
/// explains the region as paint in white light, without any indirect light, and would always win.
///
/// In the background of a live stream: one candidate a frame. It is decomposed at a quarter of the
/// frame's width, so that a frame takes about a sixteenth longer while a region is being decided;
/// at half of it (a quarter longer) for regions of fewer than 1024 pixels, and at full size (twice
/// as long) for those of fewer than 256 or that cannot be seen in a smaller frame.
class MisclusteringCorrection {
 public:
  struct Result {
    int number;   ///< of the region
    int cluster;  ///< slot that it was taken for
    int color;    ///< slot that it was given
    std::vector<std::pair<int, float>>
        scores;  ///< mean Σ_k |T_k| of its pixels for each slot tried
  };

  /// Throws Error(limit, out_of_memory).
  MisclusteringCorrection(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// After `method` has recorded a frame with `regions`: records a candidate's decomposition where
  /// a region wants one. Returns a number for `collect`.
  uint64_t record(gpu::Commands& commands, const GlobalThesis& method,
                  const MarkedRegions& regions);
  /// Reads the results of one of the last three frames, once its Commands have been waited for.
  /// Gives the result, and the region its color, when the last candidate is through.
  std::optional<Result> collect(uint64_t frame, MarkedRegions& regions);

  /// Drops what is under way: at a flush, a discontinuity or a scene cut.
  void reset();
  bool busy() const { return job_.has_value(); }
  /// Numbers of regions that no base color is left to be tried for, since this was last asked for.
  std::vector<int> take_hopeless() { return std::exchange(reported_hopeless_, {}); }

 private:
  static constexpr int kMaxHalvings = 2;
  static constexpr uint32_t kFewestPixels = 64;  ///< of a region in the smaller frame
  using RegionName = std::pair<int, uint64_t>;   ///< number, since
  /// Of a frame size, half the one before.
  struct Level {
    Extent extent;
    Plane image, regions, trial;
    std::unique_ptr<GlobalThesis> method;
  };
  struct Job {
    MarkedRegions::Region region;
    size_t level;
    std::vector<int> candidates;  ///< still to be recorded, the next one last
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
  std::vector<int> reported_hopeless_;  ///< those not asked for yet
  std::vector<RegionName> thin_;        ///< not to be seen in a smaller frame
  gpu::FrameRing<Frame> frames_;
  uint64_t recorded_ = 0;
};

}  // namespace inverse
