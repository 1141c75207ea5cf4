// SPDX-License-Identifier: LGPL-2.1-or-later
// Which tiles evaluate their edges again (docs/reference/methods/intrinsicdecomp.md, 10).
#include <algorithm>
#include <bit>
#include <random>

#include "kernels/image/pack4.hpp"
#include "kernels/intrinsic_prior_change.spv.hpp"
#include "tests/kernels/gpu_fixture.hpp"

namespace inverse::testing {

namespace {

constexpr float kTolerance = 0.05F;

struct Frame {
  Pixels level1, statistics;  ///< statistics: the mean, three unused, four sigmas
};

/// Flags by definition: a tile of 8 × 8 cells, and two cells around it, must lie within the
/// tolerance; so must the sigmas, and the mean within four times it. NaN does not lie within.
std::vector<uint32_t> changed_tiles(Extent size, const Frame& now, const Frame& saved) {
  const auto within = [](float a, float b, float tolerance) {
    return std::abs(a - b) <= tolerance;
  };
  bool statistics_within = within(now.statistics[0], saved.statistics[0], 4 * kTolerance);
  for (size_t k = 4; k < 8; ++k)
    statistics_within &= within(now.statistics[k], saved.statistics[k], kTolerance);
  std::vector<uint32_t> flags;
  for (int top = 0; top < static_cast<int>(size.height); top += 8)
    for (int left = 0; left < static_cast<int>(size.width); left += 8) {
      bool same = statistics_within;
      for (int y = std::max(top - 2, 0); y < std::min<int>(top + 10, size.height); ++y)
        for (int x = std::max(left - 2, 0); x < std::min<int>(left + 10, size.width); ++x)
          for (size_t k = 0; k < 4; ++k) {
            const size_t i = 4 * (static_cast<size_t>(y) * size.width + x) + k;
            same &= within(now.level1[i], saved.level1[i], kTolerance);
          }
      flags.push_back(same ? 0 : 1);
    }
  return flags;
}

}  // namespace

using EdgeChangesTest = GpuTest;

TEST_F(EdgeChangesTest, AgreesWithItsDefinition) {
  constexpr Extent kSize{45, 29};
  const gpu::Program<shaders::intrinsic_prior_change> change(device, {},
                                                             device->variant().area_workgroup());
  std::mt19937 random(3);
  const auto uniform = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
  };
  Frame saved{Pixels(4 * kSize.pixels()), Pixels(8)};
  for (float& value : saved.level1) value = uniform(-4, 1);
  for (float& value : saved.statistics) value = uniform(-2, 2);

  const auto expect_definition = [&](const Frame& now, bool all, size_t flagged,
                                     const std::string& what, uint32_t outdated = 0) {
    std::vector<uint32_t> expected = changed_tiles(kSize, now, saved);
    if (all || outdated != 0) std::fill(expected.begin(), expected.end(), 1);
    EXPECT_EQ(std::count(expected.begin(), expected.end(), 1U), flagged) << what;
    const auto flags = gpu::Buffer::create(device, gpu::Element::word, expected.size());
    run([&](gpu::Commands& commands) {
      commands.dispatch(change,
                        {.level1 = upload(now.level1),
                         .kept = upload(saved.level1),
                         .statistics = upload(now.statistics),
                         .kept_statistics = upload(saved.statistics),
                         .outdated = upload(gpu::Element::word, &outdated, 1),
                         .flags = flags},
                        {.size = kSize, .tolerance = kTolerance, .all = all},
                        line_of(expected.size() * change.kernel()->workgroup()));
    });
    const Pixels got = download(flags);
    for (size_t i = 0; i < expected.size(); ++i)
      EXPECT_EQ(std::bit_cast<uint32_t>(got[i]), expected[i]) << what << ", tile " << i;
  };

  constexpr size_t kTiles = 6 * 4;
  expect_definition(saved, false, 0, "the same frame");
  expect_definition(saved, true, kTiles, "no edges yet");
  expect_definition(saved, false, kTiles, "another view of the scene", 1);
  Frame now = saved;
  for (float& value : now.level1) value += uniform(-.04F, .04F);
  expect_definition(now, false, 0, "noise within the tolerance");
  now.level1[4 * (8 * kSize.width + 8) + 1] += .2F;
  expect_definition(now, false, 4, "a cell at the corner of four tiles");
  now = saved;
  now.level1[4 * (12 * kSize.width + 20) + 2] = kNan;
  expect_definition(now, false, 1, "a cell that is NaN");
  for (size_t k : {0, 4, 5, 6, 7}) {
    const float allowed = k == 0 ? 4 * kTolerance : kTolerance;
    now = saved;
    now.statistics[k] += .9F * allowed;
    expect_definition(now, false, 0, "statistic " + std::to_string(k) + " within");
    now.statistics[k] -= 2 * allowed;
    expect_definition(now, false, kTiles, "statistic " + std::to_string(k) + " beyond");
  }
  now = saved;
  now.statistics[5] = kNan;
  expect_definition(now, false, kTiles, "a statistic that is NaN");
}

}  // namespace inverse::testing
