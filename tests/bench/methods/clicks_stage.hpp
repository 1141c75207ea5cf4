// SPDX-License-Identifier: LGPL-2.1-or-later
// globalintrinsicthesis with a simulated user who has the truth: processes frames, compares
// clusters with true reflectance, marks regions.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "kernels/thesis/chapter5/correction/misclustering_correction.hpp"
#include "kernels/thesis/chapter5/correction/region_proposals.hpp"
#include "tests/bench/support/scene.hpp"
#include "truth_clicks.hpp"

namespace inverse::bench {

/// Assignment of a frame's pixels.
struct Clusters {
  std::vector<int> raw;        ///< slot by pixel, −1: none
  std::vector<int> corrected;  ///< with marked regions' base colors
  std::vector<int> region;     ///< number of the marked region, 0: none
  std::vector<int> truth;      ///< TrueSlots::nearest
  /// TrueSlots::wrong of `raw` and `corrected`.
  std::vector<uint8_t> raw_wrong, wrong;
};

class ClicksStage {
 public:
  using Mode = RegionProposals::Mode;

  ClicksStage(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Starts with the colors of a scene's first frame.
  void begin(const Image& frame, Mode mode);
  /// Processes one frame; `whole`: with default quality, so that `reflectance` is meaningful.
  void run(const Image& frame, bool whole);

  Clusters clusters(const TruthFrame& truth) const;
  /// Of the last frame, 3 channels.
  Image reflectance() const;

  MarkedRegions& regions() { return regions_; }
  bool deciding() const { return correction_.busy(); }
  /// All proposals since `begin`.
  const std::vector<RegionProposals::Proposal>& proposals() const { return proposals_made_; }
  size_t colors() const { return colors_.size(); }
  /// Total host time of proposals, milliseconds.
  double proposal_ms() const { return proposal_ms_; }

 private:
  void upload(const Image& frame);

  Extent extent_;
  gpu::Commands commands_;
  GlobalThesis method_;
  MarkedRegions regions_;
  MisclusteringCorrection correction_;
  RegionProposals proposals_;
  GlobalThesisParams cheap_, whole_;
  Plane input_;
  gpu::BufferPtr features_, marks_, intrinsic_;
  std::vector<BaseColors::Color> colors_;
  std::vector<RegionProposals::Proposal> proposals_made_;
  Mode mode_ = Mode::off;
  double proposal_ms_ = 0;
};

}  // namespace inverse::bench
