// SPDX-License-Identifier: LGPL-2.1-or-later
// What a frame skips, and when that is estimated again, without a device.
#include "kernels/intrinsic/reuse/plan.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "kernels/intrinsic/reuse/resolution_planner.hpp"

namespace inverse::testing {
namespace {

using Mode = Plan::Mode;

/// A policy and the video that it plans.
struct Video {
  Planner policy;
  Planner::Params params{true, true, true, 0.01F, 0.05F, 0.02F, 0.06F, 0.02F, 0.3F};
  Planner::Frame frame{true, false, true, 0.0F};
  Planner::Found found;
  unsigned frames = 0;

  Video() {
    found.history = true;
    found.cycles = found.cycles_recorded = 2;
    found.tiles = 100;
    found.binding = found.gate = 1;  // everything binds
  }
  Plan next() {
    Planner::Frame now = frame;
    if (frames == 0) now.history = now.layers_reusable = false;
    const bool known = frames++ >= 3;
    return policy.next(params, now, known ? std::optional(found) : std::nullopt);
  }
  Plan after(unsigned count) {
    for (unsigned k = 1; k < count; ++k) next();
    return next();
  }
};

}  // namespace

TEST(Plan, AStaticVideoIsSolvedByTilesAndSometimesWhole) {
  Video video;
  EXPECT_EQ(video.next().mode, Mode::whole) << "there is no frame before";
  EXPECT_EQ(video.next().mode, Mode::whole) << "which held nothing";
  for (int k = 0; k < 3; ++k) EXPECT_EQ(video.next().mode, Mode::watched) << k;
  unsigned all = 0, since = 0;
  for (unsigned k = 1; k <= 4 * Planner::kAllEvery; ++k) {
    const auto plan = video.next();
    ASSERT_EQ(plan.mode, Mode::tiles);
    EXPECT_FALSE(plan.measures_bins || plan.measures_gate);
    since = plan.all_tiles ? 0 : since + 1;
    EXPECT_LT(since, Planner::kAllEvery) << "no tile is left out for longer";
    all += plan.all_tiles;
  }
  EXPECT_EQ(all, 4U);
}

TEST(Plan, AChangeOfMostTilesIsSolvedWhole) {
  const auto mode = [](const auto& change) {
    Video video;
    EXPECT_EQ(video.after(8).mode, Mode::tiles);
    change(video);
    return video.next().mode;
  };
  EXPECT_EQ(mode([](Video&) {}), Mode::tiles);
  EXPECT_EQ(mode([](Video& v) { v.frame.changed = 0.2F; }), Mode::tiles);
  EXPECT_EQ(mode([](Video& v) { v.frame.changed = 0.26F; }), Mode::whole);
  EXPECT_EQ(mode([](Video& v) {
              v.frame.changed = 0.2F;
              v.params.cut_fraction = 0.2F;  // so many make a cut
            }),
            Mode::whole);
  EXPECT_EQ(mode([](Video& v) { v.params.adaptive = false; }), Mode::whole);
  EXPECT_EQ(mode([](Video& v) { v.params.tile_tolerance = 0; }), Mode::whole);
  EXPECT_EQ(mode([](Video& v) { v.frame.history = false; }), Mode::whole);
  EXPECT_EQ(mode([](Video& v) { v.frame.warm_start = true; }), Mode::whole);
  EXPECT_EQ(mode([](Video& v) { v.found.tiles_moving = 50; }), Mode::tiles);
  EXPECT_EQ(mode([](Video& v) { v.found.tiles_moving = 51; }), Mode::watched);
  EXPECT_EQ(mode([](Video& v) { v.found.drift = 0.06F; }), Mode::watched);
  EXPECT_EQ(mode([](Video& v) { v.found.drift = std::numeric_limits<float>::quiet_NaN(); }),
            Mode::watched);
  EXPECT_EQ(mode([](Video& v) { v.frame.layers_reusable = false; }), Mode::watched);
  EXPECT_EQ(mode([](Video& v) { v.policy.restart(); }), Mode::watched);
}

TEST(Plan, SkippedBinsAndAnchorAreEstimatedMoreOften) {
  const auto looks = [](bool binds, float changed) {
    Video video;
    video.frame.changed = changed;
    video.found.measured_bins = video.found.measured_gate = true;
    if (!binds) video.found.binding = 0;
    unsigned count = 0;
    for (int k = 0; k < 65; ++k) {
      const auto plan = video.next();
      if (k < 1) continue;
      count += plan.measures_bins;
      EXPECT_TRUE(plan.bins || !binds);
      EXPECT_TRUE(plan.bins || !plan.measures_bins) << "what is looked at must be there";
    }
    return count;
  };
  EXPECT_EQ(looks(true, 1), 5U);    // the 4th, the 16th, … the 64th
  EXPECT_EQ(looks(false, 1), 16U);  // every 4th
  EXPECT_EQ(looks(true, 0), 1U) << "over tiles alone there is nothing to be seen of the whole";
  Video off;
  off.frame.changed = 1;
  off.found.measured_bins = off.found.measured_gate = true;
  off.found.binding = off.found.gate = 0;
  off.after(5);
  const auto plan = off.next();
  EXPECT_FALSE(plan.bins);
  EXPECT_FALSE(plan.compares_pixels);
  off.found.cut = true;  // of another scene nothing is known
  off.found.gate = 1;
  const auto cut = off.next();
  EXPECT_TRUE(cut.bins);
  EXPECT_TRUE(cut.compares_pixels);
  off.params.adaptive = false;
  off.found.cut = false;
  off.found.gate = 0;
  EXPECT_TRUE(off.next().bins && off.next().compares_pixels) << "adaptive=false leaves nothing out";
}

TEST(Plan, EdgesAreComparedRarelyIfMostAreRecomputed) {
  Video video;
  video.frame.changed = 1;
  video.found.compared_edges = true;
  video.found.tiles_evaluated = 51;
  video.after(4);
  unsigned compared = 0;
  bool kept = false;
  for (int k = 0; k < 32; ++k) {
    const auto plan = video.next();
    const bool compares = plan.edges == Plan::Edges::compare;
    compared += compares;
    if (compares) {
      EXPECT_TRUE(kept) << "there must be something to compare with";
    }
    kept = compares || plan.edges == Plan::Edges::all_save;
  }
  EXPECT_EQ(compared, 4U);
  video.found.tiles_evaluated = 50;
  video.next();
  EXPECT_EQ(video.next().edges, Plan::Edges::compare);
}

TEST(Plan, CyclesEndEarlyWhereTheyDidOrWouldHave) {
  Video video;
  video.frame.changed = 1;
  video.found.change = 0.004F;  // above a third of `settled`
  EXPECT_TRUE(video.after(3).stops) << "nothing is known yet";
  EXPECT_FALSE(video.next().stops);
  video.found.change = 0.003F;
  EXPECT_TRUE(video.next().stops);
  video.found.change = 1;
  EXPECT_FALSE(video.next().stops);
  video.found.cycles = 1;
  EXPECT_TRUE(video.next().stops);
  video.params.settled = 0;
  EXPECT_FALSE(video.next().stops);
}

TEST(ResolutionPlan, HalfIsChosenBelowItsBoundOnly) {
  // Distances that comparisons find, and what follows three frames later.
  struct Row {
    float distance;
    bool half, far;
  };
  const ResolutionPlanner::Params params{true, 0, 0.06F};
  for (const Row& row :
       {Row{0.03F, true, false}, Row{0.047F, true, false}, Row{0.05F, false, false},
        Row{0.07F, false, false}, Row{0.1F, false, true}}) {
    ResolutionPlanner planner;
    ResolutionPlanner::Found found;
    ResolutionPlanner::Choice choice;
    for (uint64_t k = 0; k <= ResolutionPlanner::kFirst; ++k) {
      choice = planner.next(params, found);
      EXPECT_EQ(choice.compares, k == ResolutionPlanner::kFirst) << k;
    }
    found = {false, true, row.distance};
    choice = planner.next(params, found);
    EXPECT_EQ(choice.halvings, row.half ? 1U : 0U) << row.distance;
    EXPECT_EQ(choice.crosses, row.half) << row.distance;
    EXPECT_EQ(choice.half_far, row.far) << row.distance;
    // Nothing is chosen if it is set, or if nothing may be skipped.
    EXPECT_EQ(planner.next({true, 2, 0.06F}, found).halvings, 2U);
    EXPECT_EQ(planner.next({false, 0, 0.06F}, found).halvings, 0U);
    EXPECT_EQ(planner.next({true, 0, 0}, found).halvings, 0U);
  }
}

}  // namespace inverse::testing
