// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <vector>

#include "gst/base/filter.hpp"
#include "kernels/thesis/chapter5/correction/misclustering_correction.hpp"
#include "kernels/thesis/chapter5/correction/region_proposals.hpp"

namespace inverse {

/// Element messages of globalintrinsicthesis about marked regions
/// (docs/reference/elements/globalintrinsicthesis.md); all but what became of a click waits for the
/// next frame.
class RegionMessages {
 public:
  void corrected(const MisclusteringCorrection::Result& result) { corrected_.push_back(result); }
  void proposed(const RegionProposals::Proposal& proposal) { proposed_.push_back(proposal); }
  void lost(const std::vector<MarkedRegions::Lost>& lost) {
    lost_.insert(lost_.end(), lost.begin(), lost.end());
  }
  /// Forgets the messages of the previous scene, except for lost regions.
  void forget();
  bool empty() const { return corrected_.empty() && proposed_.empty() && lost_.empty(); }
  /// Posts all of them, once.
  void post(FrameContext& frame);
  /// A click was taken in as this region, 0: refused.
  static void post_marked(FrameContext& frame, int x, int y, int region);

 private:
  std::vector<MisclusteringCorrection::Result> corrected_;
  std::vector<RegionProposals::Proposal> proposed_;
  std::vector<MarkedRegions::Lost> lost_;
};

}  // namespace inverse
