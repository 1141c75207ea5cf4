// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "kernels/thesis/chapter5/global_thesis.hpp"
#include "kernels/thesis/chapter5/regions/marked_regions.hpp"
#include "kernels/thesis_chapter5_correction_survey.spv.hpp"
#include "misclustering_survey.hpp"

namespace inverse {

/// Proposes regions of a video that seem to have another base color than their cluster's
/// (find_misclustered), and marks them in Mode::correct. Every few frames the device makes a small
/// frame, which the host searches when the device is done, beside a live stream.
class RegionProposals {
 public:
  enum class Mode : uint8_t {
    off,
    report,   ///< only reports
    correct,  ///< marks the regions as a click would and gives them their supposed color
  };
  struct Proposal {
    int x, y;         ///< of a pixel of the frame in it
    uint64_t pixels;  ///< of the frame, about
    int cluster;      ///< slot that they were assigned to
    int color;        ///< slot that they seem to have
    float score;      ///< 0…1, 1 is certain
    int region;       ///< number of the marked region, 0: none
  };

  /// At most `max_count` proposals at a time. Throws Error(limit, out_of_memory).
  RegionProposals(const std::shared_ptr<gpu::Device>& device, Extent extent,
                  size_t max_count = 256);

  /// Records a small frame if one is due. Call it after `method` has recorded a frame with
  /// `regions`. Returns a number for `collect`. When the mode is no longer Mode::correct, proposed
  /// regions are removed from the next frame on (Loss::withdrawn), and pending results are ignored.
  uint64_t record(gpu::Commands& commands, const GlobalThesis& method, MarkedRegions& regions,
                  Mode mode);
  /// Reads the results of one of the last three frames, and returns new proposals. Wait for its
  /// Commands first. Mode::correct marks regions while numbers are free, and removes those that
  /// have not seemed misclustered for kMisses searches.
  std::vector<Proposal> collect(uint64_t number, MarkedRegions& regions);

  /// Does not propose this region again until `reset`.
  void refuse(int region);
  /// Discards all proposals, for a flush, a discontinuity or a scene cut.
  void reset();
  /// Whether an unchanged picture may still bring new proposals in this mode.
  bool pending(Mode mode) const { return !quiet_ || mode != mode_; }
  /// Present proposals.
  int count() const;

 private:
  static constexpr uint64_t kMaxPixels = 160 * 160;  ///< of a small frame
  static constexpr uint64_t kSoon = 4, kLater = 15;  ///< frames between two small ones
  static constexpr int kMisses = 3;                  ///< after which a proposal is over
  static constexpr int kMaxFailures = 2;             ///< after which it is refused
  struct Frame {
    gpu::BufferPtr pixels;
    std::vector<BaseColors::Color> colors;
    std::array<int, MarkedRegions::kMaxRegions + 1> given{};
    Mode mode = Mode::off;
    uint32_t epoch = 0;
    bool pending = false;
  };
  /// An earlier proposal.
  struct Seen {
    int x, y;  ///< of the small frame
    int region;
    int misses;
    bool refused;
    int failures = 0;  ///< regions that were lost
  };

  void change(Mode mode, MarkedRegions& regions);
  void forget_lost(const MarkedRegions& regions);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_, small_;
  size_t max_count_;
  int factor_ = 1;
  gpu::Program<shaders::thesis_chapter5_correction_survey> survey_;
  gpu::BufferPtr pixels_;
  gpu::FrameRing<Frame> frames_;
  std::vector<Seen> seen_;
  uint64_t recorded_ = 0, due_ = 0;
  uint32_t epoch_ = 0;     // resets
  Mode mode_ = Mode::off;  // of the frame before
  bool quiet_ = false;
};

}  // namespace inverse
