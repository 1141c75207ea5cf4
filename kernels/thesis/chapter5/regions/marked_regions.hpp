// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/components/components.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/thesis_chapter5_regions_regions_click.spv.hpp"
#include "kernels/thesis_chapter5_regions_regions_mark.spv.hpp"
#include "kernels/thesis_chapter5_regions_regions_probe.spv.hpp"

namespace inverse {

/// Regions of a video whose pixels were assigned to a wrong base color because of strong
/// inter-reflections (thesis, 5.5.2.1). A region starts at a click, is filled over cluster ids on
/// the device, is tracked from frame to frame, and can be given a base color.
class MarkedRegions {
 public:
  static constexpr int kMaxRegions = 15;    ///< numbers 1 … 15
  static constexpr size_t kMaxClicks = 16;  ///< a frame: more than kMaxRegions
  /// Maximum growth of a tracked region from one frame to the next. It is removed if it grows by
  /// more: its component has joined another one.
  static constexpr uint32_t kMaxGrowth = 3;

  struct Region {
    int number;   ///< 1 … kMaxRegions
    int cluster;  ///< slot of the palette that its pixels are assigned to; −1: not filled yet
    int color;    ///< slot of the base color given to it; −1: none yet
    uint32_t pixels = 0;          ///< in the last frame that was collected
    uint64_t since = UINT64_MAX;  ///< number of the frame in which it was filled
    bool proposed = false;        ///< by `propose`: clicked regions replace it
  };

  /// Why a region was removed.
  enum class Loss : uint8_t {
    nothing_there,  ///< no cluster was under the click
    taken_over,     ///< its pixels went to another region
    lost,           ///< none of its pixels could be tracked
    spilled,        ///< it grew into its surroundings of the same cluster (kMaxGrowth)
    no_candidates,  ///< no base color is left to try (MisclusteringCorrection)
    unmarked,       ///< removed by `remove`
    withdrawn,      ///< a proposal that no longer seems misclustered, or proposals were disabled
                    ///< (RegionProposals)
    made_room,      ///< it was proposed, and a click needed its number
    cut,            ///< scene cut
    reset,          ///< a flush, a discontinuity, another frame size
  };
  struct Lost {
    int number;
    Loss loss;
  };

  /// Throws Error(limit, out_of_memory).
  MarkedRegions(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Marks the region around a pixel in the next frame, and takes that pixel's component over from
  /// any other region. Returns the region's number, or 0 if the pixel is outside the frame or no
  /// number is free. If none is free, the smallest proposed region is removed (Loss::made_room).
  int click(int x, int y);
  /// As `click`, but marks only if the pixel still has this cluster (else Loss::nothing_there),
  /// gives the region a base color at once, and neither takes over pixels of other regions
  /// (Loss::taken_over) nor removes a region for its number.
  int propose(int x, int y, int cluster, int color);
  /// Gives a region a base color (slot); −1: that of its cluster. Ignores unknown numbers.
  void set_color(int number, int slot);
  /// False if there is no such region.
  bool remove(int number, Loss loss = Loss::unmarked);
  /// Removes all regions, for a flush, a discontinuity or a scene cut.
  void reset(Loss loss = Loss::reset);

  /// Fills and tracks regions in a frame: w of `features` is each pixel's cluster, −1 if there is
  /// none.
  void record(gpu::Commands& commands, const Plane& features);
  /// Number of the last frame that was recorded, for `collect`.
  uint64_t last() const { return recorded_ - 1; }
  /// Reads the sizes of regions in one of the last three frames, and removes lost regions. Wait for
  /// its Commands first.
  void collect(uint64_t frame);

  const std::vector<Region>& regions() const { return regions_; }
  /// Regions removed since the last call, in order.
  std::vector<Lost> take_lost() { return std::exchange(lost_, {}); }
  bool has_lost() const { return !lost_.empty(); }
  /// (slot of the given color or −1, number or 0) of each pixel of the last frame.
  Plane plane() const { return {extent_, plane_}; }

 private:
  struct Click {
    int x, y, number;
    int cluster;  // required; −1: any
  };
  int add(const Click& click, int color, bool proposed);
  struct Frame {
    gpu::BufferPtr orders, clusters, counts;
    uint32_t epoch = 0;
    bool collected = true;
  };

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  Components components_;
  gpu::Program<shaders::thesis_chapter5_regions_regions_probe> probe_;
  gpu::Program<shaders::thesis_chapter5_regions_regions_click> click_;
  gpu::Program<shaders::thesis_chapter5_regions_regions_mark> mark_;
  gpu::BufferPtr claims_, plane_, clusters_, counts_;
  gpu::FrameRing<Frame> frames_;
  std::vector<Region> regions_;  // by number
  std::vector<Click> waiting_;   // for the next frame
  std::vector<Lost> lost_;       // not taken yet
  uint64_t recorded_ = 0;
  uint32_t epoch_ = 0;  // resets
  bool clear_ = true;
};

}  // namespace inverse
