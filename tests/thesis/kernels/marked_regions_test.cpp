// SPDX-License-Identifier: LGPL-2.1-or-later
// Marked regions: filled over cluster ids, tracked, and overruled by a base color.
#include "kernels/thesis/chapter5/regions/marked_regions.hpp"

#include <map>
#include <queue>
#include <utility>

#include "global_thesis_fixture.hpp"
#include "kernels/thesis/chapter5/correction/misclustering_correction.hpp"

namespace inverse::testing {
namespace {

/// The pixels that 4-connected flood fill of equal clusters reaches from `seeds`.
std::vector<uint8_t> flood(Extent extent, const std::vector<int>& clusters,
                           const std::vector<size_t>& seeds) {
  std::vector<uint8_t> filled(clusters.size(), 0);
  std::queue<size_t> open;
  for (const size_t seed : seeds) {
    if (clusters[seed] < 0 || filled[seed]) continue;
    filled[seed] = 1;
    open.push(seed);
  }
  while (!open.empty()) {
    const size_t n = open.front();
    open.pop();
    const auto visit = [&](size_t m) {
      if (filled[m] || clusters[m] != clusters[n]) return;
      filled[m] = 1;
      open.push(m);
    };
    if (n % extent.width > 0) visit(n - 1);
    if (n % extent.width + 1 < extent.width) visit(n + 1);
    if (n >= extent.width) visit(n - extent.width);
    if (n + extent.width < extent.pixels()) visit(n + extent.width);
  }
  return filled;
}

/// Random patches of three clusters, large enough to wind about each other, and some pixels with
/// none.
std::vector<int> mottle(Extent extent, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<int> clusters(extent.pixels());
  for (size_t n = 0; n < clusters.size(); ++n) {
    const bool repeat = n % extent.width > 0 && random() % 3 != 0;
    const bool above = n >= extent.width && random() % 3 != 0;
    clusters[n] = above ? clusters[n - extent.width]
                        : (repeat ? clusters[n - 1] : static_cast<int>(random() % 4) - 1);
  }
  return clusters;
}

}  // namespace

class MarkedRegionsTest : public GpuTest {
 protected:
  Plane features(Extent extent, const std::vector<int>& clusters) {
    Pixels pixels(extent.pixels() * 4, 0.0f);
    for (size_t n = 0; n < clusters.size(); ++n)
      pixels[4 * n + 3] = static_cast<float>(clusters[n]);
    return plane(extent, pixels);
  }
  /// Numbers of the pixels after a frame with these clusters.
  std::vector<int> numbers(MarkedRegions& regions, Extent extent,
                           const std::vector<int>& clusters) {
    const Plane frame = features(extent, clusters);
    run([&](gpu::Commands& commands) { regions.record(commands, frame); });
    regions.collect(regions.last());
    const Pixels pixels = download(regions.plane());
    std::vector<int> result;
    for (size_t n = 0; n < clusters.size(); ++n)
      result.push_back(static_cast<int>(pixels[4 * n + 1]));
    return result;
  }
};

TEST_F(MarkedRegionsTest, FillsWhatFloodFillReaches) {
  for (const Extent extent : {Extent{1, 1}, Extent{2, 3}, Extent{37, 21}, Extent{200, 150}}) {
    for (unsigned seed = 0; seed < 4; ++seed) {
      const std::vector<int> clusters = mottle(extent, seed);
      const size_t at = (seed * 7919u) % extent.pixels();
      MarkedRegions regions(device, extent);
      const int number =
          regions.click(static_cast<int>(at % extent.width), static_cast<int>(at / extent.width));
      ASSERT_EQ(number, 1);
      const std::vector<int> got = numbers(regions, extent, clusters);
      const std::vector<uint8_t> expected = flood(extent, clusters, {at});
      uint32_t pixels = 0;
      for (size_t n = 0; n < got.size(); ++n) {
        ASSERT_EQ(got[n], expected[n]) << n;
        pixels += expected[n];
      }
      // Nothing is under a click where there is no cluster.
      ASSERT_EQ(regions.regions().size(), clusters[at] < 0 ? 0u : 1u);
      if (clusters[at] >= 0) {
        EXPECT_EQ(regions.regions()[0].pixels, pixels);
        EXPECT_EQ(regions.regions()[0].cluster, clusters[at]);
      }
    }
  }
}

TEST_F(MarkedRegionsTest, FillsASpiral) {
  // One pixel wide: the longest way that a fill can have.
  const Extent extent{65, 65};
  std::vector<int> clusters(extent.pixels(), 0);
  int x = 0, y = 0, dx = 1, dy = 0;
  const auto at = [&](int u, int v) -> int& {
    return clusters[static_cast<size_t>(v) * 65 + static_cast<size_t>(u)];
  };
  const auto inside = [](int u, int v) { return u >= 0 && v >= 0 && u < 65 && v < 65; };
  const auto taken = [&](int u, int v) { return inside(u, v) && at(u, v) == 1; };
  for (int turns = 0; turns < 2;) {
    at(x, y) = 1;
    if (!inside(x + dx, y + dy) || taken(x + dx, y + dy) || taken(x + 2 * dx, y + 2 * dy)) {
      ++turns;
      dx = -std::exchange(dy, dx);
      continue;
    }
    turns = 0;
    x += dx;
    y += dy;
  }
  MarkedRegions regions(device, extent);
  regions.click(0, 0);
  EXPECT_EQ(numbers(regions, extent, clusters), clusters);
}

TEST_F(MarkedRegionsTest, FollowsAMovingPatch) {
  const Extent extent{60, 40};
  const auto patch = [&](int left, int cluster) {
    std::vector<int> clusters(extent.pixels(), 0);
    for (int y = 10; y < 25; ++y)
      for (int x = left; x < left + 12; ++x)
        clusters[static_cast<size_t>(y) * 60 + static_cast<size_t>(x)] = cluster;
    return clusters;
  };
  MarkedRegions regions(device, extent);
  const int number = regions.click(10, 12);
  regions.set_color(number, 5);
  for (int left = 5; left < 40; left += 7) {
    std::vector<int> expected = patch(left, 2);
    std::replace(expected.begin(), expected.end(), 2, number);
    ASSERT_EQ(numbers(regions, extent, patch(left, 2)), expected) << "patch at " << left;
    ASSERT_EQ(download(regions.plane())[4 * (60 * 12 + static_cast<size_t>(left))], 5.0f);
  }
  // Another cluster in its place: the region is lost, and its number free again.
  numbers(regions, extent, patch(40, 3));
  EXPECT_TRUE(regions.regions().empty());
  EXPECT_EQ(regions.click(45, 12), number);
  EXPECT_EQ(numbers(regions, extent, patch(40, 3))[60 * 12 + 45], number);
}

TEST_F(MarkedRegionsTest, BadClicksAndManyAreRefused) {
  const Extent extent{32, 24};
  MarkedRegions regions(device, extent);
  EXPECT_EQ(regions.click(-1, 0), 0);
  EXPECT_EQ(regions.click(0, 24), 0);
  EXPECT_EQ(regions.click(32, 0), 0);
  std::vector<int> clusters(extent.pixels());
  for (size_t n = 0; n < clusters.size(); ++n) clusters[n] = static_cast<int>(n % 2);  // stripes
  int taken = 0;
  for (int i = 0; i < 300; ++i) taken += regions.click(i % 32, i % 24) > 0;
  EXPECT_EQ(taken, MarkedRegions::kMaxRegions);
  const std::vector<int> got = numbers(regions, extent, clusters);
  std::map<int, int> pixels;
  for (const int number : got) ++pixels[number];
  EXPECT_EQ(pixels.size(), 1u + MarkedRegions::kMaxRegions);
  EXPECT_EQ(numbers(regions, extent, clusters), got);
  // A click into a region that is marked already takes it over.
  regions.remove(1);
  EXPECT_EQ(regions.click(1, 1), 1);
  numbers(regions, extent, clusters);
  EXPECT_EQ(regions.regions().size(), static_cast<size_t>(MarkedRegions::kMaxRegions) - 1);
  regions.reset();
  EXPECT_EQ(numbers(regions, extent, clusters), std::vector<int>(clusters.size(), 0));
}

TEST_F(MarkedRegionsTest, AClickTakesOverWhateverTheNumbers) {
  const Extent extent{40, 20};
  std::vector<int> clusters(extent.pixels());
  for (size_t n = 0; n < clusters.size(); ++n) clusters[n] = n % 40 < 20 ? 0 : 1;
  MarkedRegions regions(device, extent);
  ASSERT_EQ(regions.click(5, 5), 1);
  ASSERT_EQ(regions.click(30, 5), 2);
  numbers(regions, extent, clusters);
  EXPECT_TRUE(regions.remove(1));
  EXPECT_FALSE(regions.remove(1));
  ASSERT_EQ(regions.click(30, 15), 1);  // lower than the number of the region there
  for (int t = 0; t < 2; ++t) ASSERT_EQ(numbers(regions, extent, clusters), clusters) << t;
  ASSERT_EQ(regions.regions().size(), 1u);
  const auto lost = regions.take_lost();
  ASSERT_EQ(lost.size(), 2u);
  EXPECT_EQ(lost[0].number, 1);
  EXPECT_EQ(lost[0].loss, MarkedRegions::Loss::unmarked);
  EXPECT_EQ(lost[1].number, 2);
  EXPECT_EQ(lost[1].loss, MarkedRegions::Loss::taken_over);
}

TEST_F(MarkedRegionsTest, ReportsWhyARegionWasRemoved) {
  using Loss = MarkedRegions::Loss;
  const Extent extent{40, 20};
  const std::vector<int> none(extent.pixels(), -1), red(extent.pixels(), 0),
      blue(extent.pixels(), 1);
  MarkedRegions regions(device, extent);
  const auto losses = [&] {
    std::vector<std::pair<int, Loss>> result;
    for (const auto& lost : regions.take_lost()) result.emplace_back(lost.number, lost.loss);
    return result;
  };
  using Losses = std::vector<std::pair<int, Loss>>;
  regions.click(5, 5);
  numbers(regions, extent, none);
  EXPECT_EQ(losses(), (Losses{{1, Loss::nothing_there}}));
  // Two clicks on one component in one frame.
  regions.click(5, 5);
  regions.click(15, 5);
  numbers(regions, extent, red);
  EXPECT_EQ(losses(), (Losses{{1, Loss::taken_over}}));
  // The region's cluster is gone, while another region is clicked.
  regions.click(3, 3);
  numbers(regions, extent, blue);
  EXPECT_EQ(losses(), (Losses{{2, Loss::lost}}));
  numbers(regions, extent, blue);
  EXPECT_FALSE(regions.has_lost());
  regions.reset(Loss::cut);
  EXPECT_EQ(losses(), (Losses{{1, Loss::cut}}));
  numbers(regions, extent, blue);
  EXPECT_FALSE(regions.has_lost());
}

/// A light floor between a red and a blue wall, with a strip in the shade that sees the red wall
/// only and is taken for red.
class MisclusteringTest : public GlobalThesisTest {
 protected:
  static constexpr Extent kExtent{48, 36};
  void SetUp() override {
    GlobalThesisTest::SetUp();
    pixels = room(kExtent, 1, 0, 0);
    inside.assign(kExtent.pixels(), 0);
    for (size_t n = 0; n < kExtent.pixels(); ++n) {
      inside[n] = n % 48 >= 18 && n % 48 < 26 && n / 48 >= 8 && n / 48 < 28;
      if (!inside[n]) continue;
      for (size_t c = 0; c < 3; ++c) pixels[4 * n + c] = 0.9f * (0.05f + 0.4f * kRoom[0][c]);
    }
    params.refine_rounds = 0;
  }
  Pixels pixels;
  std::vector<uint8_t> inside;
  GlobalThesisParams params;
};

TEST_F(MisclusteringTest, RegionsOverrideClustersAndTheScoreFindsTheSparsestColor) {
  const Extent extent = kExtent;
  const Plane frame = plane(extent, pixels);
  std::vector<float> scores;
  for (int candidate = 0; candidate < 3; ++candidate) {
    GlobalThesis method(device, extent);
    method.set_params(params);
    method.set_base_colors(kRoom);
    MarkedRegions regions(device, extent);
    const int number = regions.click(20, 12);
    regions.set_color(number, candidate);
    const auto stats = decompose(method, frame, {&regions, nullptr, number});
    regions.collect(regions.last());
    ASSERT_EQ(regions.regions().size(), 1u);
    EXPECT_EQ(regions.regions()[0].cluster, 0);  // red
    const auto colors = to_reference(method.colors().layer_colors());
    const reference::Plane targets = targets_of(method, extent);
    for (size_t n = 0; n < extent.pixels(); ++n) {
      if (!inside[n]) continue;
      for (size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(targets.data[n][c], std::log(colors[static_cast<size_t>(candidate)][c]), 1e-5);
    }
    const double expected =
        reference::sparsity_score(to_field(extent, 3, download(method.solution())), inside);
    EXPECT_NEAR(stats.score, expected, 1e-4 * expected);
    EXPECT_EQ(stats.region, 8 * 20);
    scores.push_back(stats.score);
  }
  // Red paint in white light needs no indirect light at all and would be sparser than the truth:
  // the color that a region was taken for is no candidate.
  EXPECT_LT(scores[0], scores[2]);
  EXPECT_LT(scores[2], 0.5f * scores[1]);
}

TEST_F(MisclusteringTest, TheCorrectionFindsTheColorInTheBackground) {
  // Three frames in flight, once with and once without the correction.
  std::vector<Pixels> results[2];
  for (const bool correct : {false, true}) {
    GlobalThesis method(device, kExtent);
    method.set_params(params);
    method.set_base_colors(kRoom);
    MarkedRegions regions(device, kExtent);
    MisclusteringCorrection correction(device, kExtent);
    const int number = regions.click(20, 12);
    const Plane frame = plane(kExtent, pixels);
    std::array<uint64_t, gpu::kFramesInFlight> corrections{};
    std::optional<MisclusteringCorrection::Result> result;
    std::array<Layers, 4> outputs;
    play_frames(
        20,
        [&](gpu::Commands& commands, size_t t) {
          method.record(commands, frame, outputs[std::min<size_t>(t, 3) - (t > 3)], {&regions});
          if (correct)
            corrections[t % corrections.size()] = correction.record(commands, method, regions);
        },
        [&](size_t t) {
          method.collect(t);
          regions.collect(t);
          if (t == 3) results[correct].push_back(download(outputs[3][Role::intrinsic]));
          if (correct && !result)
            result = correction.collect(corrections[t % corrections.size()], regions);
          return !result;
        });
    if (!correct) continue;
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(result->number, number);
    EXPECT_EQ(result->cluster, 0);
    EXPECT_EQ(result->color, 2);
    EXPECT_EQ(result->scores.size(), 2u);
    EXPECT_FALSE(correction.busy());
    ASSERT_EQ(regions.regions().size(), 1u);
    EXPECT_EQ(regions.regions()[0].color, 2);
  }
  EXPECT_EQ(results[0], results[1]);  // frames are what they are without it
}

TEST_F(MisclusteringTest, TheCorrectionIgnoresVanishedRegions) {
  GlobalThesis method(device, kExtent);
  method.set_params(params);
  method.set_base_colors(kRoom);
  MarkedRegions regions(device, kExtent);
  MisclusteringCorrection correction(device, kExtent);
  const Plane frame = plane(kExtent, pixels);
  const auto step = [&] {
    uint64_t number = 0, own = 0;
    run([&](gpu::Commands& commands) {
      number = method.record(commands, frame, output_, {&regions});
      own = correction.record(commands, method, regions);
    });
    method.collect(number);
    regions.collect(regions.last());
    return correction.collect(own, regions);
  };
  // The region is removed, or the scene cut, in the middle.
  const int number = regions.click(20, 12);
  step();
  EXPECT_FALSE(step());
  EXPECT_TRUE(correction.busy());
  regions.remove(number);
  for (int t = 0; t < 4; ++t) EXPECT_FALSE(step());
  EXPECT_FALSE(correction.busy());
  regions.click(20, 12);
  step();
  step();
  correction.reset();
  regions.reset();
  for (int t = 0; t < 4; ++t) EXPECT_FALSE(step());
  EXPECT_FALSE(correction.busy());
  // One base color leaves no candidate.
  method.set_base_colors(std::vector<Rgb>{kRoom[0]});
  regions.click(20, 12);
  for (int t = 0; t < 4; ++t) EXPECT_FALSE(step());
  EXPECT_FALSE(correction.busy());
  EXPECT_EQ(regions.regions().size(), 1u);
  EXPECT_EQ(correction.take_hopeless(), std::vector{regions.regions()[0].number});
  EXPECT_TRUE(correction.take_hopeless().empty());
}

}  // namespace inverse::testing
