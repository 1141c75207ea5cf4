// SPDX-License-Identifier: LGPL-2.1-or-later
// Misclustered regions that are found without a click.
#include "kernels/thesis/chapter5/correction/region_proposals.hpp"

#include <algorithm>
#include <cmath>

#include "global_thesis_fixture.hpp"

namespace inverse::testing {
namespace {

constexpr Extent kExtent{96, 72};
// Red, blue, light gray.
constexpr int kRed = 0, kGray = 2;

struct Stage {
  bool wall = true;      ///< red; else gray
  bool shade = true;     ///< on the floor before it: only light from the wall gets there
  bool painted = false;  ///< red paint in its place, without shade
  float noise = 0;
  uint32_t shift = 0;  ///< of the shade
};

bool in_shade(const Stage& stage, size_t n) {
  const size_t x = n % kExtent.width, y = n / kExtent.width;
  return x >= 34 + stage.shift && x < 50 + stage.shift && y >= 20 && y < 50;
}

/// A wall to the left, a gray floor and a blue wall to the right.
Pixels stage_pixels(const Stage& stage) {
  Pixels pixels(4 * kExtent.pixels(), 1);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (size_t n = 0; n < kExtent.pixels(); ++n) {
    const size_t x = n % kExtent.width;
    const bool inside = in_shade(stage, n);
    const Rgb wall = kRoom[static_cast<size_t>(stage.wall ? kRed : kGray)];
    const Rgb paint = x < 30                    ? wall
                      : x >= 80                 ? kRoom[1]
                      : inside && stage.painted ? kRoom[kRed]
                                                : kRoom[kGray];
    const float direct = inside && stage.shade && !stage.painted ? 0.01F : 0.5F;
    const float spill = 0.15F * std::exp(-static_cast<float>(x) / 96);
    for (size_t c = 0; c < 3; ++c)
      pixels[4 * n + c] = paint[c] * (direct + spill * wall[c]) * (1 + stage.noise * unit(random));
  }
  return pixels;
}

SurveyResult search(const Pixels& pixels, int region = 0, int given = -1, const Stage& stage = {}) {
  BaseColors colors;
  colors.set(kRoom);
  std::vector<float> survey(4 * kExtent.pixels());
  for (size_t n = 0; n < kExtent.pixels(); ++n) {
    std::copy_n(&pixels[4 * n], 3, &survey[4 * n]);
    const float mean = (survey[4 * n] + survey[4 * n + 1] + survey[4 * n + 2]) / 3 + 3e-3F;
    float smallest = 3.4e38F;
    for (const auto& color : colors.colors()) {
      float d2 = 0;
      for (size_t c = 0; c < 3; ++c) {
        const float d = std::log((survey[4 * n + c] + 3e-3F) / mean) - color.center[c];
        d2 += d * d;
      }
      if (d2 >= smallest) continue;
      smallest = d2;
      survey[4 * n + 3] = static_cast<float>(color.slot + 1);
    }
    if (in_shade(stage, n)) survey[4 * n + 3] += static_cast<float>(Survey::kClusterCodes * region);
  }
  Survey of{kExtent, survey, colors.colors(), {}};
  of.given.fill(-1);
  if (region > 0) of.given.at(static_cast<size_t>(region)) = given;
  return find_misclustered(of);
}

TEST(FindMisclustered, FindsShadeOfTheWallsColor) {
  for (const float noise : {0.0F, 0.05F}) {
    const SurveyResult result = search(stage_pixels({.noise = noise}));
    ASSERT_EQ(result.found.size(), 1U) << noise;
    const Misclustered& found = result.found[0];
    EXPECT_EQ(found.cluster, kRed);
    EXPECT_EQ(found.color, kGray);
    EXPECT_NEAR(found.pixels, 16 * 30, 4);
    EXPECT_GT(found.score, 0.3F);
    EXPECT_NEAR(found.x, 41.5F, 2.5F);
    EXPECT_GE(found.y, 27);
    EXPECT_LT(found.y, 43);
    EXPECT_EQ(result.components[static_cast<size_t>(found.y) * kExtent.width +
                                static_cast<size_t>(found.x)],
              found.component);
  }
}

TEST(FindMisclustered, IgnoresPaintAndUnexplainedRegions) {
  EXPECT_TRUE(search(stage_pixels({.shade = false})).found.empty());
  EXPECT_TRUE(search(stage_pixels({.painted = true})).found.empty());
  // The same shade without any red around it: it can only be paint.
  Pixels alone = stage_pixels({.wall = false, .shade = false});
  const Pixels shaded = stage_pixels({});
  for (size_t n = 0; n < kExtent.pixels(); ++n)
    if (in_shade({}, n)) std::copy_n(&shaded[4 * n], 3, &alone[4 * n]);
  EXPECT_TRUE(search(alone).found.empty());
}

TEST(FindMisclustered, ReportsTheMarkedRegionOfAPixel) {
  const SurveyResult result = search(stage_pixels({}), 3, kGray);
  ASSERT_EQ(result.found.size(), 1U);
  EXPECT_EQ(result.found[0].region, 3);
  EXPECT_EQ(result.found[0].color, kGray);
}

TEST(FindMisclustered, TakesAnything) {
  BaseColors colors;
  for (const Extent extent : {Extent{1, 1}, {1, 40}, {40, 1}, {64, 48}}) {
    for (const size_t count : {size_t{0}, size_t{1}, size_t{16}}) {
      colors.set(random_colors(count, 3));
      std::mt19937 random(extent.width);
      std::vector<float> pixels = random_pixels(extent, 4, 0, 1e4F);
      for (size_t n = 0; n < extent.pixels(); ++n)
        pixels[4 * n + 3] = static_cast<float>(random() % 600);
      Survey survey{extent, pixels, colors.colors(), {}};
      survey.given.fill(15);
      const SurveyResult result = find_misclustered(survey);
      EXPECT_EQ(result.components.size(), extent.pixels());
      for (const Misclustered& found : result.found) {
        EXPECT_LT(found.x, static_cast<int>(extent.width));
        EXPECT_LT(found.y, static_cast<int>(extent.height));
      }
    }
  }
}

class RegionProposalsTest : public GlobalThesisTest {
 protected:
  using Mode = RegionProposals::Mode;
  using Loss = MarkedRegions::Loss;

  void SetUp() override {
    GlobalThesisTest::SetUp();
    method.emplace(device, kExtent);
    method->set_params({.steps = 1, .pcg_iterations = 1, .refine_rounds = 0});
    method->set_base_colors(kRoom);
    regions.emplace(device, kExtent);
    proposals.emplace(device, kExtent);
  }
  /// Frames of the same picture, with as many in flight as there may be. All that was proposed.
  std::vector<RegionProposals::Proposal> play(const Pixels& pixels, Mode mode, int frames) {
    return play(pixels, std::vector<Mode>(static_cast<size_t>(frames), mode));
  }
  std::vector<RegionProposals::Proposal> play(const Pixels& pixels,
                                              const std::vector<Mode>& modes) {
    std::vector<RegionProposals::Proposal> all;
    const Plane frame = plane(kExtent, pixels);
    std::array<std::array<uint64_t, 3>, gpu::kFramesInFlight> numbers{};
    play_frames(
        modes.size(),
        [&](gpu::Commands& commands, size_t t) {
          const uint64_t number = method->record(commands, frame, output_, {&*regions});
          numbers[t % numbers.size()] = {number, regions->last(),
                                         proposals->record(commands, *method, *regions, modes[t])};
        },
        [&](size_t t) {
          const auto& [number, region, proposal] = numbers[t % numbers.size()];
          method->collect(number);
          regions->collect(region);
          for (const auto& made : proposals->collect(proposal, *regions)) all.push_back(made);
          return true;
        });
    return all;
  }
  /// Why regions were removed since the last call.
  std::vector<Loss> losses() {
    std::vector<Loss> all;
    for (const auto& lost : regions->take_lost()) all.push_back(lost.loss);
    return all;
  }
  std::optional<GlobalThesis> method;
  std::optional<MarkedRegions> regions;
  std::optional<RegionProposals> proposals;
};

TEST_F(RegionProposalsTest, ReportsOnceAndMarksNothing) {
  const auto proposed = play(stage_pixels({}), Mode::report, 60);
  ASSERT_EQ(proposed.size(), 1U);
  EXPECT_EQ(proposed[0].cluster, kRed);
  EXPECT_EQ(proposed[0].color, kGray);
  EXPECT_EQ(proposed[0].region, 0);
  EXPECT_TRUE(in_shade(
      {}, static_cast<size_t>(proposed[0].y) * kExtent.width + static_cast<size_t>(proposed[0].x)));
  EXPECT_TRUE(regions->regions().empty());
  EXPECT_EQ(proposals->count(), 1);
  EXPECT_FALSE(proposals->pending(Mode::report));
  EXPECT_TRUE(proposals->pending(Mode::correct));
  EXPECT_TRUE(play(stage_pixels({}), Mode::off, 5).empty());
  EXPECT_EQ(proposals->count(), 0);
}

TEST_F(RegionProposalsTest, MarksAndGivesTheColor) {
  const Pixels pixels = stage_pixels({});
  const auto proposed = play(pixels, Mode::correct, 30);
  ASSERT_EQ(proposed.size(), 1U);
  EXPECT_EQ(proposed[0].region, 1);
  ASSERT_EQ(regions->regions().size(), 1U);
  EXPECT_TRUE(regions->regions()[0].proposed);
  EXPECT_EQ(regions->regions()[0].color, kGray);
  const Pixels marks = download(regions->plane().buffer);
  size_t off = 0;
  for (size_t n = 0; n < kExtent.pixels(); ++n)
    off += (static_cast<int>(marks[4 * n]) == kGray) != in_shade({}, n);
  EXPECT_LE(off, 4U);
  // It follows the shade, and goes with it.
  for (uint32_t shift = 2; shift <= 8; shift += 2)
    play(stage_pixels({.shift = shift}), Mode::correct, 4);
  ASSERT_EQ(regions->regions().size(), 1U);
  play(stage_pixels({.shade = false}), Mode::correct, 40);
  EXPECT_TRUE(regions->regions().empty());
}

TEST_F(RegionProposalsTest, OutdatedProposalsAreWithdrawn) {
  play(stage_pixels({}), Mode::correct, 30);
  ASSERT_EQ(regions->regions().size(), 1U);
  regions->take_lost();
  // The light is turned on, and it turns out to be paint.
  play(stage_pixels({.painted = true}), Mode::correct, 60);
  EXPECT_TRUE(regions->regions().empty());
  EXPECT_EQ(losses(), std::vector{Loss::withdrawn});
}

TEST_F(RegionProposalsTest, RejectedProposalsAreNotRepeated) {
  ASSERT_EQ(play(stage_pixels({}), Mode::correct, 30).size(), 1U);
  proposals->refuse(1);
  EXPECT_TRUE(regions->remove(1));
  EXPECT_TRUE(play(stage_pixels({}), Mode::correct, 60).empty());
  EXPECT_TRUE(regions->regions().empty());
  EXPECT_FALSE(proposals->pending(Mode::correct));
  proposals->reset();
  EXPECT_EQ(play(stage_pixels({}), Mode::correct, 30).size(), 1U);
}

TEST_F(RegionProposalsTest, ClicksComeFirst) {
  // There is a click already.
  ASSERT_EQ(regions->click(40, 30), 1);
  EXPECT_TRUE(play(stage_pixels({}), Mode::correct, 30).empty());
  regions->reset();
  // All numbers are taken, one of them by a proposal.
  ASSERT_EQ(play(stage_pixels({}), Mode::correct, 30).size(), 1U);
  regions->take_lost();
  for (int k = 1; k < MarkedRegions::kMaxRegions; ++k) EXPECT_EQ(regions->click(60, 30), k + 1);
  EXPECT_EQ(regions->propose(60, 30, kGray, kRed), 0);
  EXPECT_EQ(regions->click(60, 30), 1);
  EXPECT_EQ(losses(), std::vector{Loss::made_room});
  EXPECT_EQ(regions->click(60, 30), 0);
}

TEST_F(RegionProposalsTest, AProposalTakesNoClickOver) {
  const Pixels pixels = stage_pixels({});
  const auto only_the_click = [&](int click, int proposal, const char* when) {
    ASSERT_EQ(regions->regions().size(), 1U) << when;
    EXPECT_EQ(regions->regions()[0].number, click) << when;
    EXPECT_FALSE(regions->regions()[0].proposed) << when;
    EXPECT_GT(regions->regions()[0].pixels, 400U) << when;
    const auto lost = regions->take_lost();
    ASSERT_EQ(lost.size(), 1U) << when;
    EXPECT_EQ(lost[0].number, proposal) << when;
    EXPECT_EQ(lost[0].loss, Loss::taken_over) << when;
  };
  // Both with one frame, either number the higher one.
  for (const bool click_first : {true, false}) {
    int click = click_first ? regions->click(40, 30) : 0;
    const int proposal = regions->propose(42, 35, kRed, kGray);
    if (!click_first) click = regions->click(40, 30);
    ASSERT_EQ(std::min(click, proposal), 1);
    play(pixels, Mode::off, 2);
    only_the_click(click, proposal, click_first ? "click first" : "proposal first");
    regions->reset();
    regions->take_lost();
  }
  // The click was taken a frame or two before; the proposal is of a frame before that.
  for (const int before : {1, 2}) {
    const int click = regions->click(40, 30);
    play(pixels, Mode::off, before);
    const int proposal = regions->propose(42, 35, kRed, kGray);
    ASSERT_GT(proposal, click);
    play(pixels, Mode::off, 2);
    only_the_click(click, proposal, "click before");
    regions->reset();
    regions->take_lost();
  }
  // Earlier proposals stay only where no click was.
  const int proposal = regions->propose(42, 35, kRed, kGray);
  play(pixels, Mode::off, 2);
  const int click = regions->click(40, 30);
  play(pixels, Mode::off, 2);
  only_the_click(click, proposal, "click afterwards");
}

TEST_F(RegionProposalsTest, OffStopsWhatIsUnderWay) {
  const Pixels pixels = stage_pixels({});
  // The survey of the first frame is still to come when proposing ends.
  ASSERT_EQ(play(pixels, {Mode::correct}).size(), 1U);
  regions->reset();
  proposals->reset();
  for (const Mode mode : {Mode::off, Mode::report}) {
    const auto proposed = play(pixels, {Mode::correct, mode, mode, mode, mode, mode});
    EXPECT_EQ(proposed.size(), mode == Mode::report ? 1U : 0U);
    for (const auto& proposal : proposed) EXPECT_EQ(proposal.region, 0);
    EXPECT_TRUE(regions->regions().empty());
    proposals->reset();
  }
}

TEST_F(RegionProposalsTest, ProposalsEndWithTheMode) {
  const Pixels pixels = stage_pixels({});
  for (const Mode mode : {Mode::off, Mode::report}) {
    ASSERT_EQ(play(pixels, Mode::correct, 30).size(), 1U);
    ASSERT_EQ(regions->regions().size(), 1U);
    const int clicked = regions->click(60, 30);  // stays
    regions->take_lost();
    EXPECT_TRUE(play(pixels, mode, 20).empty());
    ASSERT_EQ(regions->regions().size(), 1U);
    EXPECT_EQ(regions->regions()[0].number, clicked);
    EXPECT_EQ(losses(), std::vector{Loss::withdrawn});
    EXPECT_EQ(proposals->count(), mode == Mode::report ? 1 : 0);
    regions->remove(clicked);
  }
  // And is marked again.
  ASSERT_EQ(play(pixels, Mode::correct, 30).size(), 1U);
  EXPECT_EQ(regions->regions().size(), 1U);
}

TEST_F(RegionProposalsTest, WithoutRoomForMoreNothingIsProposed) {
  proposals.emplace(device, kExtent, 0);
  for (const Mode mode : {Mode::report, Mode::correct}) {
    EXPECT_TRUE(play(stage_pixels({}), mode, 40).empty());
    EXPECT_TRUE(regions->regions().empty());
  }
}

TEST_F(RegionProposalsTest, AProposalThatComesTooLateMarksNothing) {
  ASSERT_EQ(regions->propose(40, 30, kRed, kGray), 1);
  play(stage_pixels({.shade = false}), Mode::off, 6);
  EXPECT_TRUE(regions->regions().empty());
  EXPECT_EQ(losses(), std::vector{Loss::nothing_there});
}

TEST_F(RegionProposalsTest, ARegionThatRunsOverGoes) {
  play(stage_pixels({}), Mode::off, 3);
  ASSERT_EQ(regions->click(40, 30), 1);
  play(stage_pixels({}), Mode::off, 6);
  ASSERT_EQ(regions->regions().size(), 1U);
  regions->take_lost();
  // The shade reaches the wall: they are one component then.
  Pixels joined = stage_pixels({});
  const Pixels shade = joined;
  for (size_t n = 0; n < kExtent.pixels(); ++n)
    if (n % kExtent.width >= 30 && n % kExtent.width < 34)
      std::copy_n(&shade[4 * (30 * kExtent.width + 40)], 3, &joined[4 * n]);
  play(joined, Mode::off, 6);
  EXPECT_TRUE(regions->regions().empty());
  EXPECT_EQ(losses(), std::vector{Loss::spilled});
}

TEST_F(RegionProposalsTest, SurvivesFramesThatAreNoPictures) {
  Pixels bad = random_pixels(kExtent, 3, -1e6F, 1e6F);
  for (size_t n = 0; n < bad.size(); n += 5) bad[n] = kNan;
  for (const Mode mode : {Mode::report, Mode::correct}) play(bad, mode, 20);
  EXPECT_EQ(play(stage_pixels({}), Mode::correct, 60).size(), 1U);
}

}  // namespace
}  // namespace inverse::testing
