// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/thesis_chapter5_regions_components_join.spv.hpp"
#include "kernels/thesis_chapter5_regions_components_start.spv.hpp"
#include "kernels/thesis_chapter5_regions_regions_click.spv.hpp"
#include "kernels/thesis_chapter5_regions_regions_mark.spv.hpp"
#include "kernels/thesis_chapter5_regions_regions_probe.spv.hpp"

namespace inverse {

/// Regions of a video that look like another base color than they have, as strong inter-reflections
/// make them (thesis, 5.5.2.1): each begins with a click, is filled over cluster ids, follows its
/// pixels from frame to frame by probe and fill, and may be given a base color. All of the filling
/// is done on the device.
class MarkedRegions {
 public:
  static constexpr int kMaxRegions = 15;    ///< numbers 1 … 15
  static constexpr size_t kMaxClicks = 16;  ///< taken in a frame: more than there are numbers
  /// A tracked region that grows by more from one frame to the next is no longer what was marked:
  /// its component has joined another one, and goes.
  static constexpr uint32_t kMaxGrowth = 3;

  struct Region {
    int number;   ///< 1 … kMaxRegions
    int cluster;  ///< slot of the palette that its pixels are assigned to; −1: not filled yet
    int color;    ///< slot of the base color that it is given; −1: none yet
    uint32_t pixels = 0;          ///< in the last frame that was collected
    uint64_t since = UINT64_MAX;  ///< number of the frame that took its click in
    bool proposed = false;        ///< by `propose`: gives way to what was clicked
  };

  /// Why a region was removed.
  enum class Loss : uint8_t {
    nothing_there,  ///< no cluster was under the click
    taken_over,     ///< its pixels went to another region
    lost,           ///< none of its pixels could be followed
    spilled,        ///< it grew into its surroundings of the same cluster (kMaxGrowth)
    no_candidates,  ///< there was no base color to give it (MisclusteringCorrection)
    unmarked,       ///< somebody removed it
    withdrawn,      ///< a proposal that no longer seems misclustered, or proposals were disabled
                    ///< (RegionProposals)
    made_room,      ///< it was proposed, and a click needed its number
    cut,            ///< of the scene
    reset,          ///< a flush, a discontinuity, another frame size
  };
  struct Lost {
    int number;
    Loss loss;
  };

  /// Throws Error(limit, out_of_memory).
  MarkedRegions(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Marks the region around a pixel, from the next frame on. Returns its number, or 0 if the
  /// pixel is outside the frame or all numbers are taken. A click into a region that is marked
  /// already makes another one, which takes its pixels over. Where all numbers are taken, the
  /// smallest region that was only proposed gives its own away.
  int click(int x, int y);
  /// The same without anybody's click, where a number is free and if the pixel still has that
  /// cluster then (Loss::nothing_there if not); gives the region a base color at once. Takes
  /// nothing over from other regions (Loss::taken_over), whether they were marked before or are
  /// with the same frame; a click takes it over.
  int propose(int x, int y, int cluster, int color);
  /// The base color (slot) that a region has whatever it looks like; −1: that of its cluster.
  /// Numbers that mark nothing are ignored.
  void set_color(int number, int slot);
  /// False if the number marks nothing.
  bool remove(int number, Loss loss = Loss::unmarked);
  /// Forgets all regions: at a flush, a discontinuity or a scene cut.
  void reset(Loss loss = Loss::reset);

  /// Takes in a frame: w of `features` is each pixel's cluster, −1 if there is none.
  void record(gpu::Commands& commands, const Plane& features);
  /// Number of the last frame that was recorded, for `collect`.
  uint64_t last() const { return recorded_ - 1; }
  /// Takes in the regions' sizes of one of the last three frames, once its Commands have been
  /// waited for. Regions that are lost (no pixel is left, or there was no cluster under the click)
  /// go.
  void collect(uint64_t frame);

  const std::vector<Region>& regions() const { return regions_; }
  /// Regions that went since this was last asked for, in that order.
  std::vector<Lost> take_lost() { return std::exchange(lost_, {}); }
  bool has_lost() const { return !lost_.empty(); }
  /// (slot of the color that overrules the cluster or −1, number or 0) of each pixel of the last
  /// frame.
  Plane plane() const { return {extent_, plane_}; }

 private:
  struct Click {
    int x, y, number;
    int cluster;  // that there must be, −1: any
  };
  int add(const Click& click, int color, bool proposed);
  struct Frame {
    gpu::BufferPtr orders, clusters, counts;
    uint32_t epoch = 0;
    bool collected = true;
  };

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  gpu::Program<shaders::thesis_chapter5_regions_components_start> start_;
  gpu::Program<shaders::thesis_chapter5_regions_components_join> join_;
  gpu::Program<shaders::thesis_chapter5_regions_regions_probe> probe_;
  gpu::Program<shaders::thesis_chapter5_regions_regions_click> click_;
  gpu::Program<shaders::thesis_chapter5_regions_regions_mark> mark_;
  gpu::BufferPtr roots_, claims_, plane_, clusters_, counts_;
  gpu::FrameRing<Frame> frames_;
  std::vector<Region> regions_;  // by number
  std::vector<Click> waiting_;   // for the next frame
  std::vector<Lost> lost_;       // not asked for yet
  uint64_t recorded_ = 0;
  uint32_t epoch_ = 0;  // resets
  bool clear_ = true;
};

}  // namespace inverse
