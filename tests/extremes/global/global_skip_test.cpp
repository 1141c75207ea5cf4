// SPDX-License-Identifier: LGPL-2.1-or-later
// globalintrinsic while it holds a scene's light and works on tiles, and bad input comes in one of
// them: finite layers that say what they claim to say, and near those of adaptive=false.
#include <gtest/gtest.h>

#include <cmath>

#include "global_methods.hpp"
#include "tests/extremes/support/window.hpp"

namespace inverse::extremes {
namespace {

// rms over pixels from adaptive=false: of the light's color, log units, its mean over channels
// taken out, and of its direct share.
constexpr double kMaxColor = 0.05, kMaxShare = 0.05;

struct Counts {
  unsigned frames = 0, held = 0, listed = 0;  // with bad input in a tile
  double color = 0, share = 0;                // the worst of frames whose light is reused
};

struct Apart {
  double color = 0, share = 0;
};
/// Of light, in color and in direct share.
Apart apart(const Pixels& a, const Pixels& b) {
  Apart sum;
  for (size_t i = 0; i < a.size(); i += 4) {
    double off[3], mean = 0;
    for (size_t c = 0; c < 3; ++c) {
      const auto log_of = [&](float v) { return std::log(std::max(static_cast<double>(v), 1e-6)); };
      off[c] = log_of(a[i + c]) - log_of(b[i + c]);
      mean += off[c] / 3;
    }
    for (const double d : off) sum.color += (d - mean) * (d - mean) / 3;
    sum.share += std::pow(static_cast<double>(a[i + 3] - b[i + 3]), 2);
  }
  const auto pixels = static_cast<double>(a.size() / 4);
  return {std::sqrt(sum.color / pixels), std::sqrt(sum.share / pixels)};
}

/// A picture stays until its light is reused; then bad frames come, go and come again in a window
/// of it, once the whole frame is bad, and light is reused again after it.
std::optional<std::string> wrong_light(const Lab& lab, const Case& small, Counts& counts) {
  const Case one = enlarged(small, 64);
  const Extent extent{one.width, one.height};
  const Pixels picture = clean_picture(one);
  GlobalMethod some(lab, Solver::global, extent), whole(lab, Solver::global, extent);
  GlobalIntrinsic::Params params = global_params_of(one);
  some.set(params);
  params.adaptive = false;
  whole.set(params);
  constexpr uint32_t kFirst = 14, kWhole = 20, kLast = 42;
  // Within one tile, so that it and those beside it are few.
  const auto place = [&](uint32_t draw, uint32_t side) {
    return draw % ((side + 15) / 16) * 16 + draw % 4;
  };
  const SpoiltVideo video{one,
                          picture,
                          {place(one.seed * 7, one.width), place(one.seed * 13, one.height)},
                          kFirst,
                          kWhole};
  Pixels before;
  for (uint32_t k = 0; k < kLast; ++k) {
    const Pixels frame = video.frame(k);
    const bool bad = video.bad(k);
    const auto changed =
        before.empty() ? std::vector<uint8_t>() : changed_tiles(extent, before, frame);
    const GlobalLayers got = some.decompose(frame, changed);
    before = frame;
    if (auto wrong = wrong_global_layers(Solver::global, k, frame, got, params.white_balance > 0))
      return wrong;
    const bool held = some.last_stats().light.reused();
    counts.frames += bad;
    counts.held += bad && held;
    counts.listed += bad && some.last_stats().solve.plan.tiles();
    // Light of 1e4 in a tile makes another scene of the frame, which only shows when it is looked
    // at again: finite and R S L = I is all that is asked of frames before that.
    if (one.knobs != 0 || one.faults & kBeyondFormats) continue;
    const GlobalLayers all = whole.decompose(frame);
    if (!held) continue;
    const Apart off = apart(got.light, all.light);
    counts.color = std::max(counts.color, off.color);
    counts.share = std::max(counts.share, off.share);
    if (!(off.color < kMaxColor && off.share < kMaxShare))
      return "light held in frame " + std::to_string(k) + " is off by " +
             std::to_string(off.color) + " in color and " + std::to_string(off.share) +
             " in direct share";
  }
  return {};
}

class GlobalSkip : public testing::Test {
 protected:
  const Lab lab_;
  Counts counts_;
  const Check check_ = [this](const Case& one) { return wrong_light(lab_, one, counts_); };
  void report() const {
    printf(
        "  %u frames, light held in %u, %u by tiles; from adaptive=false %.4f in color, %.4f in "
        "direct share\n",
        counts_.frames, counts_.held, counts_.listed, counts_.color, counts_.share);
    EXPECT_GT(counts_.held, counts_.frames / 4);
  }
};

TEST_F(GlobalSkip, EveryFaultInATileWhileLightIsReused) {
  for (uint32_t fault = 0; fault < kFaults; ++fault)
    for (const Extent extent : {Extent{31, 18}, Extent{300, 1}}) {
      const Case one{Solver::global, extent.width, extent.height, 1, fault + 1, 1U << fault, 0};
      const auto wrong = check_(one);
      EXPECT_FALSE(wrong) << name_of(static_cast<Fault>(fault)) << ": " << one.text() << ": "
                          << *wrong;
    }
  report();
}

TEST_F(GlobalSkip, MixturesInATileWhileLightIsReused) {
  const auto failure = first_failure(Solver::global, 1, 20, 48, check_);
  EXPECT_FALSE(failure) << *failure;
  report();
}

}  // namespace
}  // namespace inverse::extremes
