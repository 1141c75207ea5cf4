// SPDX-License-Identifier: LGPL-2.1-or-later
#include "region_messages.hpp"

namespace inverse {
namespace {

const char* reason(MarkedRegions::Loss loss) {
  switch (loss) {
    case MarkedRegions::Loss::nothing_there:
      return "no-cluster";
    case MarkedRegions::Loss::taken_over:
      return "merged";
    case MarkedRegions::Loss::lost:
      return "lost";
    case MarkedRegions::Loss::spilled:
      return "spilled";
    case MarkedRegions::Loss::no_candidates:
      return "no-candidates";
    case MarkedRegions::Loss::unmarked:
      return "unmarked";
    case MarkedRegions::Loss::withdrawn:
      return "withdrawn";
    case MarkedRegions::Loss::made_room:
      return "evicted";
    case MarkedRegions::Loss::cut:
      return "cut";
    case MarkedRegions::Loss::reset:
      return "reset";
  }
  return "";
}

}  // namespace

void RegionMessages::forget() {
  corrected_.clear();
  proposed_.clear();
}

void RegionMessages::post(FrameContext& frame) {
  for (const auto& result : corrected_)
    frame.messages.emplace_back(gst_structure_new(
        "inverse-region-corrected", "region", G_TYPE_INT, result.number, "cluster", G_TYPE_INT,
        result.cluster, "color", G_TYPE_INT, result.color, nullptr));
  for (const auto& proposal : proposed_)
    frame.messages.emplace_back(gst_structure_new(
        "inverse-region-proposed", "x", G_TYPE_INT, proposal.x, "y", G_TYPE_INT, proposal.y,
        "pixels", G_TYPE_UINT64, proposal.pixels, "cluster", G_TYPE_INT, proposal.cluster, "color",
        G_TYPE_INT, proposal.color, "score", G_TYPE_DOUBLE, static_cast<double>(proposal.score),
        "region", G_TYPE_INT, proposal.region, nullptr));
  for (const auto& lost : lost_)
    frame.messages.emplace_back(gst_structure_new("inverse-region-lost", "region", G_TYPE_INT,
                                                  lost.number, "reason", G_TYPE_STRING,
                                                  reason(lost.loss), nullptr));
  forget();
  lost_.clear();
}

void RegionMessages::post_marked(FrameContext& frame, int x, int y, int region) {
  frame.messages.emplace_back(gst_structure_new("inverse-region-marked", "x", G_TYPE_INT, x, "y",
                                                G_TYPE_INT, y, "region", G_TYPE_INT, region,
                                                nullptr));
}

}  // namespace inverse
