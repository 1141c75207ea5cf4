// SPDX-License-Identifier: LGPL-2.1-or-later
// What a frame skips, and when that is estimated again, without a device.
#include "kernels/reuse/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "kernels/intrinsic/intrinsic_decomposition.hpp"
#include "kernels/reuse/resolution_planner.hpp"

namespace inverse::testing {
namespace {

/// A policy and the video that it plans.
struct Video {
  Planner policy;
  Planner::Params params;
  Planner::Frame frame{.history = true};
  Planner::Found found;
  unsigned frames = 0;

  Video() {
    found.plan.history = true;
    found.cycles = found.plan.cycles = 2;
    found.tiles = 100;
    found.binding = found.gate = 1;  // everything binds
  }
  Plan next() {
    Planner::Frame now = frame;
    if (frames == 0) now.history = false;
    const bool known = frames++ >= 3;
    return policy.next(params, now, known ? std::optional(found) : std::nullopt);
  }
  Plan after(unsigned count) {
    for (unsigned k = 1; k < count; ++k) next();
    return next();
  }
};

}  // namespace

TEST(Plan, SkippedBinsAndAnchorAreEstimatedMoreOften) {
  const auto measured = [](bool binds) {
    Video video;
    video.found.plan.measures_bins = video.found.plan.measures_gate = true;
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
  EXPECT_EQ(measured(true), 5U);    // the 4th, the 16th, … the 64th
  EXPECT_EQ(measured(false), 16U);  // every 4th
  Video off;
  off.found.plan.measures_bins = off.found.plan.measures_gate = true;
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
  video.found.plan.edges = Plan::Edges::compare;
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
  video.found.change = 0.004F;  // above a third of `cycle-tolerance`
  EXPECT_TRUE(video.after(3).stops()) << "nothing is known yet";
  EXPECT_FALSE(video.next().stops());
  video.found.change = 0.003F;
  EXPECT_TRUE(video.next().stops());
  video.found.change = 1;
  EXPECT_FALSE(video.next().stops());
  video.found.cycles = 1;
  EXPECT_TRUE(video.next().stops());
  video.params.tolerances.cycle = 0;
  EXPECT_FALSE(video.next().stops());
}

/// A row of recorded_facts.csv (plan-facts): a frame's facts, what it found, and its plan.
struct RecordedFrame {
  Planner::Frame frame;
  Planner::Found found;
};

std::map<std::string, std::vector<RecordedFrame>> recorded_scenes() {
  std::ifstream file(RECORDED_FACTS_PATH);
  std::map<std::string, std::vector<RecordedFrame>> scenes;
  std::string line;
  std::getline(file, line);  // names
  while (std::getline(file, line)) {
    const size_t comma = line.find(',');
    std::string numbers = line.substr(comma + 1);
    std::replace(numbers.begin(), numbers.end(), ',', ' ');
    std::istringstream row(numbers);
    RecordedFrame r;
    int edges = 0;
    row >> r.frame.history >> r.frame.repeated >> r.found.cycles >> r.found.change >> r.found.cut >>
        r.found.tiles >> r.found.tiles_evaluated >> r.found.binding >> r.found.gate >> edges >>
        r.found.plan.cycles >> r.found.plan.cycle_tolerance >> r.found.plan.compares_pixels >>
        r.found.plan.bins >> r.found.plan.measures_bins >> r.found.plan.measures_gate;
    EXPECT_FALSE(row.fail()) << line;
    r.found.plan.edges = Plan::Edges(edges);
    r.found.plan.history = r.frame.history;
    scenes[line.substr(0, comma)].push_back(r);
  }
  return scenes;
}

TEST(Plan, RecordedFactsOfTheAdaptivityScenesLeadToTheRecordedPlans) {
  const auto scenes = recorded_scenes();
  ASSERT_EQ(scenes.size(), 5U);
  const IntrinsicDecomposition::Params defaults;
  for (const auto& [name, frames] : scenes) {
    Planner planner;
    planner.restart();
    ASSERT_EQ(frames.size(), 60U) << name;
    for (size_t k = 0; k < frames.size(); ++k) {
      std::optional<Planner::Found> found;
      if (k >= gpu::kFramesInFlight) found = frames[k - gpu::kFramesInFlight].found;
      Plan plan = planner.next({.cycles = defaults.cycles, .warm_cycles = defaults.warm_cycles},
                               frames[k].frame, found);
      plan.skipped.clear();  // reasons are not recorded
      plan.run.clear();
      EXPECT_EQ(plan, frames[k].found.plan) << name << ", frame " << k;
    }
  }
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
    EXPECT_EQ(choice.half_rejected, row.far) << row.distance;
    // Nothing is chosen if it is set, or if nothing may be skipped.
    EXPECT_EQ(planner.next({true, 2, 0.06F}, found).halvings, 2U);
    EXPECT_EQ(planner.next({false, 0, 0.06F}, found).halvings, 0U);
    EXPECT_EQ(planner.next({true, 0, 0}, found).halvings, 0U);
  }
}

}  // namespace inverse::testing
