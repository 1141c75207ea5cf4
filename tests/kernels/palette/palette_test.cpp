// SPDX-License-Identifier: LGPL-2.1-or-later
// The palette on the device against the double-precision reference.
#include "kernels/palette/palette.hpp"

#include "kernels/palette/scene_palette.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/reference/palette/palette.hpp"
#include "tests/reference/palette/scene_palette.hpp"

namespace inverse::testing {

class PaletteTest : public GpuTest {
 protected:
  std::vector<Palette::Cluster> update(Palette& palette, const Plane& log_reflectance) {
    run([&](gpu::Commands& commands) { palette.record_update(commands, log_reflectance); });
    const Pixels colors = download(palette.colors());
    return Palette::read(colors.data(), palette.params().clusters);
  }

  /// Clusters that have pixels and are not merged into another.
  static int used(const std::vector<Palette::Cluster>& clusters) {
    int count = 0;
    for (size_t k = 0; k < clusters.size(); ++k) count += clusters[k].index == static_cast<int>(k);
    return count;
  }

  /// ln R of pixels around `colors` distinct colors.
  static Pixels blobs(Extent extent, int colors, unsigned seed, float spread) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(0.05f, 0.95f);
    std::normal_distribution<float> noise(0, spread);
    std::vector<std::array<float, 3>> centers(static_cast<size_t>(colors));
    for (auto& center : centers) {
      for (float& c : center) c = value(random);
    }
    Pixels pixels(extent.pixels() * 4);
    for (size_t n = 0; n < extent.pixels(); ++n) {
      const auto& center = centers[random() % centers.size()];
      for (size_t c = 0; c < 3; ++c) pixels[4 * n + c] = std::log(center[c]) + noise(random) - 2;
    }
    return pixels;
  }
};

TEST_F(PaletteTest, AgreesWithReferenceOverTime) {
  for (const Extent extent :
       {Extent{1, 1}, Extent{2, 3}, Extent{1, 40}, Extent{64, 48}, Extent{349, 287}}) {
    for (const int colors : {1, 4, 7, 10, -4, -10}) {
      // Negative: as the thesis' global method asks for it.
      Palette palette(device);
      if (colors < 0) palette.set_params({.fade = 0.3f, .apart = 0.3f});
      reference::Palette expected(colors < 0 ? reference::PaletteParams{.apart = 0.3, .fade = 0.3}
                                             : reference::PaletteParams{});
      for (unsigned t = 0; t < 4; ++t) {
        // The same colors, other noise; from the third frame on one color more.
        const Pixels pixels = blobs(extent, std::abs(colors) + (t > 1 ? 1 : 0), 7, 0.02f);
        const auto got = update(palette, plane(extent, pixels));
        expected.update(to_reference(extent, pixels));
        EXPECT_NEAR(download(palette.scale())[0], expected.scale(), 1e-4);
        ASSERT_EQ(got.size(), expected.clusters().size());
        for (size_t k = 0; k < got.size(); ++k) {
          const auto& cluster = expected.clusters()[k];
          ASSERT_EQ(got[k].index, cluster.weight > 0 ? cluster.alias : -1)
              << extent.width << ", " << colors << " colors, frame " << t << ", cluster " << k;
          if (got[k].index < 0) continue;
          const auto& merged = expected.clusters()[static_cast<size_t>(cluster.alias)].merged;
          for (size_t c = 0; c < 3; ++c) ASSERT_NEAR(got[k].color[c], merged[c], 1e-4);
        }
      }
    }
  }
}

TEST_F(PaletteTest, RemovesVanishedColorsAtTheGivenRate) {
  const Extent extent{64, 48};
  const Pixels both = blobs(extent, 2, 7, 0.001f);
  Pixels one = both;
  for (size_t n = 0; n < extent.pixels(); ++n) std::copy_n(&both[0], 4, &one[4 * n]);
  for (const float fade : {0.1f, 0.3f, 1.0f}) {
    Palette palette(device);
    palette.set_params({.clusters = 2, .fade = fade});
    reference::Palette expected({.clusters = 2, .fade = double{fade}});
    std::ptrdiff_t alive = 2;
    int frames = 0;
    for (int t = 0; t < 200 && alive == 2; ++t) {
      const Pixels& pixels = t < 3 ? both : one;
      const auto clusters = update(palette, plane(extent, pixels));
      alive = std::count_if(clusters.begin(), clusters.end(),
                            [](const auto& cluster) { return cluster.index >= 0; });
      expected.update(to_reference(extent, pixels));
      ASSERT_EQ(alive, std::count_if(expected.clusters().begin(), expected.clusters().end(),
                                     [](const auto& cluster) { return cluster.weight > 0; }))
          << fade << ", frame " << t;
      frames = t - 2;
    }
    // Some 1500 pixels of several bins fade to a thousandth of one.
    const float largest = fade < 1 ? std::log(1.5e6f) / -std::log(1 - fade) : 1;
    EXPECT_LE(static_cast<float>(frames), largest + 1) << fade;
    EXPECT_GE(static_cast<float>(frames), 0.4f * largest) << fade;
  }
}

TEST_F(PaletteTest, AssignsTheNearestCluster) {
  const Extent extent{67, 49};
  const Pixels pixels = blobs(extent, 6, 3, 0.3f);
  const Plane input = plane(extent, pixels), output = plane(extent);
  Palette palette(device);
  const auto clusters = update(palette, input);
  run([&](gpu::Commands& commands) { palette.record_assign(commands, input, output); });
  const Pixels got = download(output);
  for (size_t n = 0; n < extent.pixels(); ++n) {
    const auto index = static_cast<size_t>(got[4 * n + 3]);
    ASSERT_LT(index, clusters.size());
    ASSERT_EQ(clusters[index].index, static_cast<int>(index));
    const auto distance = [&](const Palette::Cluster& cluster) {
      float sum = 0;
      for (size_t c = 0; c < 3; ++c) {
        sum +=
            (pixels[4 * n + c] - cluster.log_color[c]) * (pixels[4 * n + c] - cluster.log_color[c]);
      }
      return sum;
    };
    for (size_t k = 0; k < clusters.size(); ++k) {
      if (clusters[k].index == static_cast<int>(k)) {
        ASSERT_LE(distance(clusters[index]), distance(clusters[k]) + 1e-5f);
      }
    }
  }
}

TEST_F(PaletteTest, IndicesStayWithTheirColors) {
  const Extent extent{64, 48};
  Palette palette(device);
  const auto first = update(palette, plane(extent, blobs(extent, 5, 11, 0.02f)));
  for (int t = 0; t < 20; ++t) {
    const auto now = update(palette, plane(extent, blobs(extent, 5, 11, 0.02f)));
    for (size_t k = 0; k < now.size(); ++k) {
      EXPECT_EQ(now[k].index, first[k].index);
      for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(now[k].color[c], first[k].color[c], 0.02);
    }
  }
}

TEST_F(PaletteTest, RecoversFromABlackStart) {
  const Extent extent{64, 48};
  Palette palette(device);
  update(palette, plane(extent, Pixels(extent.pixels() * 4, std::log(1e-3f))));
  std::vector<Palette::Cluster> clusters;
  const Plane colorful = plane(extent, blobs(extent, 5, 2, 0.02f));
  for (int t = 0; t < 60; ++t) clusters = update(palette, colorful);
  EXPECT_GE(used(clusters), 5);
}

TEST_F(PaletteTest, BlackGrayAndWhiteStayApart) {
  const Extent extent{48, 48};
  Pixels pixels(extent.pixels() * 4);
  const float values[] = {0.02f, 0.4f, 0.9f};
  for (size_t n = 0; n < extent.pixels(); ++n) {
    for (size_t c = 0; c < 4; ++c) pixels[4 * n + c] = std::log(values[n % 3]);
  }
  Palette palette(device);
  const auto clusters = update(palette, plane(extent, pixels));
  EXPECT_EQ(used(clusters), 3);
}

TEST_F(PaletteTest, ExtremeInputStaysFinite) {
  const Extent extent{17, 5};
  for (const float fill : {-60.0f, 0.0f, 60.0f, -16.0f, 16.0f}) {
    Palette palette(device);
    const Plane input = plane(extent, Pixels(extent.pixels() * 4, fill)), output = plane(extent);
    for (int t = 0; t < 3; ++t) {
      for (const auto& cluster : update(palette, input)) {
        for (const float c : cluster.color) ASSERT_TRUE(std::isfinite(c)) << fill;
        for (const float c : cluster.log_color) ASSERT_TRUE(std::isfinite(c)) << fill;
      }
    }
    run([&](gpu::Commands& commands) { palette.record_assign(commands, input, output); });
    ASSERT_TRUE(all_finite(download(output)));
  }
}

TEST_F(PaletteTest, ScenePaletteFindsAndPaintsTheColorsOfAFrame) {
  const Extent extent{349, 287};  // more than it samples
  const float colors[4][3] = {
      {0.8f, 0.1f, 0.1f}, {0.1f, 0.6f, 0.2f}, {0.1f, 0.2f, 0.7f}, {0, 0, 0}};
  Pixels pixels(extent.pixels() * 4, 1.0f);
  const auto color_of = [&](size_t n) {
    return colors[(n % extent.width / 90 + n / extent.width / 70) % 4];
  };
  for (size_t n = 0; n < extent.pixels(); ++n)
    for (size_t c = 0; c < 3; ++c) pixels[4 * n + c] = color_of(n)[c];
  pixels[0] = NAN;  // what a broken element may hand on
  pixels[5] = INFINITY;
  ScenePalette palette(device, extent);
  const Plane model = plane(extent, pixels), painted = plane(extent);
  run([&](gpu::Commands& commands) {
    palette.record_update(commands, model);
    palette.record_paint(commands, model, painted);
  });
  const Pixels got = download(painted);
  for (size_t n = 2; n < extent.pixels(); ++n)
    for (size_t c = 0; c < 3; ++c)
      // Black is what ln R takes it for, and a bin of the histogram has a width.
      ASSERT_NEAR(got[4 * n + c], color_of(n)[c], 0.02f) << n;
  EXPECT_TRUE(all_finite(got));
}

// What the palette is fed with shows in its clusters, which have to be the reference's.
TEST_F(PaletteTest, PickAndPaintAgreeWithReference) {
  for (const Extent extent : kOddSizes) {
    Pixels pixels = random_pixels(extent, 4, -0.1f, 1.2f);
    pixels[0] = NAN;
    pixels[pixels.size() / 8 * 4 + 1] = INFINITY;
    const Plane model = plane(extent, pixels), painted = plane(extent);
    ScenePalette palette(device, extent);
    run([&](gpu::Commands& commands) {
      palette.record_update(commands, model);
      palette.record_paint(commands, model, painted);
    });
    int stride = 1;  // the least that leaves no more than 20 000 pixels
    while (extent.pixels() / static_cast<uint64_t>(stride * stride) > 20'000) ++stride;
    const reference::Plane doubles = to_reference(extent, pixels);
    reference::Palette expected{reference::PaletteParams()};
    expected.update(reference::pick(doubles, stride));

    const Pixels colors = download(palette.palette().colors());
    std::vector<reference::Vec3> own;  // the device's, so that borders between them are, too
    size_t used = 0;
    for (const auto& cluster : Palette::read(colors.data(), palette.palette().params().clusters)) {
      const int k = static_cast<int>(used++);
      const auto& wanted = expected.clusters()[static_cast<size_t>(k)];
      ASSERT_EQ(cluster.index, wanted.weight > 0 ? wanted.alias : -1) << extent.width << ", " << k;
      if (cluster.index < 0) continue;
      const auto& merged = expected.clusters()[static_cast<size_t>(cluster.index)].merged;
      for (size_t c = 0; c < 3; ++c) ASSERT_NEAR(cluster.color[c], merged[c], 1e-3) << k;
      own.push_back({cluster.log_color[0], cluster.log_color[1], cluster.log_color[2]});
    }
    const reference::Plane want = reference::paint(doubles, own);
    const Pixels got = download(painted);
    size_t elsewhere = 0;  // as near to another color, to single precision
    for (size_t n = 0; n < want.size(); ++n) {
      bool same = true;
      for (size_t c = 0; c < 4; ++c)
        same &= std::abs(got[4 * n + c] - want.data[n][c]) <= 1e-5 * (1 + want.data[n][c]);
      elsewhere += !same;
    }
    EXPECT_LE(elsewhere, want.size() / 5000) << name_of(extent);
  }
}

}  // namespace inverse::testing
