// SPDX-License-Identifier: LGPL-2.1-or-later
// Recoloring against its specification, on ordinary and on hostile layers.
#include "kernels/edit/recolor.hpp"

#include "tests/kernels/edit/edit_fixture.hpp"
#include "tests/reference/edit/edit.hpp"

namespace inverse::testing {
namespace {

reference::RecolorSpec spec_of(const RecolorParams& params) {
  const auto &k = params.key, &t = params.target;
  return {{k[0], k[1], k[2]}, {t[0], t[1], t[2]}, params.tolerance, params.value_tolerance,
          params.softness,    params.texture,     params.strength,  params.brightness,
          params.hue_shift,   params.own_color};
}

}  // namespace

class RecolorTest : public EditorTest {
 protected:
  void run_recolor(Layers& layers, const RecolorParams& params) {
    Recolor recolor(device, layers.extent);
    record(recolor, layers, params);
  }
  void record(Recolor& recolor, Layers& layers, const RecolorParams& params) {
    run([&](gpu::Commands& commands) { recolor.record(commands, layers, params); });
  }
  std::vector<Palette::Cluster> clusters_of(const Recolor& recolor, const RecolorParams& params) {
    return Palette::read(download(recolor.palette()->colors()).data(), params.clusters);
  }
};

TEST_F(RecolorTest, RecolorAgreesWithReference) {
  RecolorParams params{.key = {0.6f, 0.3f, 0.2f}, .target = {0.1f, 0.7f, 0.9f}};
  for (const Extent extent : kOddSizes)
    for (const bool hostile : {false, true})
      for (const float value_tolerance : {0.5f, RecolorParams::kAnyValue})
        for (const float texture : {0.0f, 0.6f, 1.0f}) {
          params.value_tolerance = value_tolerance;
          params.texture = texture;
          params.strength = texture == 1 ? 1.0f : 0.7f;
          const Pixels pixels = any_pixels(extent, extent.width, hostile);
          Layers frame = layers(extent, pixels);
          run_recolor(frame, params);
          ASSERT_NO_FATAL_FAILURE(expect_pixels(
              download(frame[Role::intrinsic]),
              [&](size_t n) { return reference::recolor(pixel_of(pixels, n), spec_of(params)); },
              // Numbers beyond any picture: ln and exp cost a few digits there.
              hostile ? 1e-3 : 2e-4, hostile ? "hostile" : "random"));
          // A pixel of 8192×16 or 349×287 costs as much as any other: one texture is enough there.
          if (extent.pixels() > 5000) break;
        }
}

TEST_F(RecolorTest, HardEdgeSelectsExactlyTheKeysNeighborhood) {
  const Extent extent{64, 33};
  const Pixels pixels = random_pixels(extent, 5);
  const RecolorParams params{.key = {0.5f, 0.4f, 0.3f}, .softness = 0, .texture = 0};
  Layers frame = layers(extent, pixels);
  run_recolor(frame, params);
  const Pixels got = download(frame[Role::intrinsic]);
  reference::RecolorSpec spec = spec_of(params);
  size_t inside = 0, outside = 0;
  for (size_t n = 0; n < extent.pixels(); ++n) {
    spec.tolerance = params.tolerance + 1e-3;
    const bool maybe = reference::selection(pixel_of(pixels, n), spec) > 0;
    spec.tolerance = params.tolerance - 1e-3;
    const bool surely = reference::selection(pixel_of(pixels, n), spec) > 0;
    if (maybe != surely) continue;  // too near to the edge for single precision
    for (size_t c = 0; c < 3; ++c) {
      const float expected = surely ? params.target[c] : pixels[4 * n + c];
      ASSERT_NEAR(got[4 * n + c], expected, surely ? 1e-6 : 0.0) << n;
    }
    ++(surely ? inside : outside);
  }
  EXPECT_GT(inside, 100u);
  EXPECT_GT(outside, 100u);
}

TEST_F(RecolorTest, HueBrightnessAndMasksAgreeWithReference) {
  const Extent extent{61, 34};
  for (const bool hostile : {false, true}) {
    const Pixels pixels = any_pixels(extent, 15, hostile);
    const Pixels mask =
        hostile ? any_pixels(extent, 16, true) : random_pixels(extent, 16, -.3F, 1.1F);
    for (const bool own : {false, true})
      for (const float hue : {0.F, 30.F, -120.F, 400.F}) {
        const RecolorParams params{.by_mask = true,
                                   .target = {.1F, .5F, .3F},
                                   .texture = .8F,
                                   .brightness = .6F,
                                   .own_color = own,
                                   .hue_shift = hue};
        Layers frame = layers(extent, pixels);
        frame[Role::mask] = shared_plane(extent, mask);
        run_recolor(frame, params);
        reference::Rgb sum{};
        double weight = 0;
        for (size_t n = 0; n < extent.pixels(); ++n) {
          const double matte = std::min(reference::finite(double(mask[4 * n])), 1.0);
          const auto p = reference::finite(pixel_of(pixels, n));
          for (size_t c = 0; c < 3; ++c) sum[c] += matte * matte * p[c];
          weight += matte * matte;
        }
        const double key_value = (sum[0] + sum[1] + sum[2]) / 3 / weight + 1e-3;
        const Pixels got = download(frame[Role::intrinsic]);
        ASSERT_NO_FATAL_FAILURE(expect_pixels(
            got,
            [&](size_t n) {
              auto wanted = reference::recolor(pixel_of(pixels, n), 1, key_value, spec_of(params),
                                               pixel_of(mask, n));
              // Where huge numbers cancel, single precision keeps nothing to compare.
              for (size_t c = 0; c < 4; ++c)
                if (std::abs(pixels[4 * n + c]) > 1e3F || std::abs(mask[4 * n + c]) > 1e3F)
                  for (size_t k = 0; k < 4; ++k) wanted[k] = got[4 * n + k];
              return wanted;
            },
            hostile ? 2e-3 : 2e-4, hostile ? "hostile" : "random"));
      }
  }
}

// At the edge of an object, a pixel is a mixture. Its share of what is behind stays.
TEST_F(RecolorTest, AnObjectsEdgeKeepsWhatIsBehind) {
  const float red[] = {.6F, .06F, .03F}, green[] = {.1F, .4F, .1F};
  Pixels pixels, mask;
  for (int n = 0; n <= 10; ++n) {
    const float alpha = 1 - .1F * float(n);
    for (size_t c = 0; c < 3; ++c) pixels.push_back(alpha * red[c] + (1 - alpha) * green[c]);
    pixels.push_back(1);
    mask.push_back(alpha);
    for (size_t c = 0; c < 3; ++c) mask.push_back(green[c] - pixels[4 * size_t(n) + c]);
  }
  Layers frame = layers({11, 1}, pixels);
  frame[Role::mask] = shared_plane({11, 1}, mask);
  const RecolorParams params{.by_mask = true, .target = {.05F, .1F, .5F}, .texture = 0};
  run_recolor(frame, params);
  const Pixels got = download(frame[Role::intrinsic]);
  for (size_t n = 0; n < 11; ++n)
    for (size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(got[4 * n + c], mask[4 * n] * params.target[c] + (1 - mask[4 * n]) * green[c],
                  1e-5)
          << n;
}

TEST_F(RecolorTest, WithoutAMaskNothingIsRecoloredByIt) {
  Layers frame = layers({16, 16}, random_pixels({16, 16}, 3));
  Recolor recolor(device, frame.extent);
  run([&](gpu::Commands& commands) {
    recolor.record(commands, frame, {.by_mask = true});
    EXPECT_EQ(commands.dispatches(), 0u);
  });
}

TEST_F(RecolorTest, KeyBecomesTargetAndShadingStays) {
  const RecolorParams params{.key = {0.6f, 0.2f, 0.1f}, .target = {0.2f, 0.3f, 0.8f}};
  Layers frame = layers({1, 1}, {0.6f, 0.2f, 0.1f, 0.7f});
  run_recolor(frame, params);
  const Pixels got = download(frame[Role::intrinsic]);
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(got[c], params.target[c], 1e-5);
  EXPECT_EQ(got[3], 0.7f);
}

TEST_F(RecolorTest, SelectionSurvivesShadowAndDarkPaint) {
  // The same paint in light, in shadow and twice as dark is one color; texture keeps its variation.
  const RecolorParams params{.key = {0.6f, 0.2f, 0.1f}, .target = {0.2f, 0.3f, 0.8f}};
  Layers frame =
      layers({3, 1}, {0.6f, 0.2f, 0.1f, 1.0f, 0.6f, 0.2f, 0.1f, 0.05f, 0.3f, 0.1f, 0.05f, 1.0f});
  run_recolor(frame, params);
  const Pixels got = download(frame[Role::intrinsic]);
  for (size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(got[c], params.target[c], 1e-4);
    EXPECT_NEAR(got[4 + c], params.target[c], 1e-4);
    EXPECT_NEAR(got[8 + c], params.target[c] / 2, 2e-3);
  }
}

TEST_F(RecolorTest, MaskMultipliesAndSelectionIsPassedOn) {
  const Extent extent{37, 11};
  const Pixels pixels = random_pixels(extent, 7), matte = any_pixels(extent, 8, true);
  RecolorParams params{.write_mask = true};
  for (const bool use_mask : {true, false}) {
    params.use_mask = use_mask;
    Layers frame = layers(extent, pixels);
    const PlanePtr mask = frame[Role::mask] = shared_plane(extent, matte);
    run_recolor(frame, params);
    const auto matte_at = [&](size_t n) { return use_mask ? matte[4 * n] : 1.0f; };
    const reference::RecolorSpec spec = spec_of(params);
    expect_pixels(
        download(frame[Role::intrinsic]),
        [&](size_t n) {
          return reference::recolor(pixel_of(pixels, n),
                                    use_mask ? pixel_of(matte, n) : reference::Rgba{1, 0, 0, 0},
                                    spec);
        },
        1e-4, "intrinsic");
    EXPECT_NE(frame[Role::mask], mask);
    expect_pixels(
        download(frame[Role::mask]),
        [&](size_t n) -> reference::Rgba {
          return {reference::selection(pixel_of(pixels, n), spec) *
                      std::min(reference::finite(matte_at(n)), 1.0),
                  0, 0, 0};
        },
        1e-4, "mask");
  }
}

/// Vertical stripes of flat colors under uneven light; every color has its noise.
Pixels striped_pixels(Extent extent, const std::vector<reference::Rgb>& colors, unsigned seed) {
  Pixels pixels = random_pixels(extent, seed, 0.97f, 1.03f);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const auto& color = colors[x * colors.size() / extent.width];
      float* p = &pixels[4 * (static_cast<size_t>(y) * extent.width + x)];
      for (size_t c = 0; c < 3; ++c) p[c] *= static_cast<float>(color[c]);
      p[3] = 0.2f + 0.8f * static_cast<float>(y) / static_cast<float>(extent.height);
    }
  return pixels;
}

TEST_F(RecolorTest, ClusterRecolorsItsStripeOnly) {
  const Extent extent{320, 200};  // larger than the palette's sample
  const std::vector<reference::Rgb> colors{
      {0.8, 0.8, 0.8}, {0.1, 0.1, 0.1}, {0.6, 0.1, 0.1}, {0.1, 0.2, 0.6}};
  const Pixels pixels = striped_pixels(extent, colors, 1);
  Recolor recolor(device, extent);
  RecolorParams params{.clusters = 6, .target = {0.1f, 0.7f, 0.2f}, .texture = 0};
  std::vector<bool> found(colors.size());
  for (params.cluster = 0; params.cluster < params.clusters; ++params.cluster) {
    Layers frame = layers(extent, pixels);
    record(recolor, frame, params);
    const Pixels got = download(frame[Role::intrinsic]);
    ASSERT_NE(recolor.palette(), nullptr);
    const auto clusters = clusters_of(recolor, params);
    const int stands = clusters[static_cast<size_t>(params.cluster)].index;
    size_t changed = 0;
    std::vector<size_t> by_stripe(colors.size());
    for (uint32_t n = 0; n < extent.pixels(); ++n)
      if (got[4 * n] != pixels[4 * n]) {
        ++changed;
        ++by_stripe[n % extent.width * colors.size() / extent.width];
      }
    if (stands < 0) {
      EXPECT_EQ(changed, 0u) << "a cluster without pixels changed something";
      continue;
    }
    const size_t stripe = static_cast<size_t>(std::max_element(by_stripe.begin(), by_stripe.end()) -
                                              by_stripe.begin());
    EXPECT_EQ(by_stripe[stripe], changed) << "more than one stripe changed";
    EXPECT_EQ(changed, extent.pixels() / colors.size()) << "the stripe changed in part";
    found[stripe] = true;
  }
  EXPECT_EQ(found, std::vector<bool>(colors.size(), true));
  for (params.cluster = params.clusters; params.cluster < 12; ++params.cluster) {
    Layers frame = layers(extent, pixels);
    record(recolor, frame, params);
    EXPECT_EQ(download(frame[Role::intrinsic]), pixels) << "a cluster that was not searched for";
  }
}

TEST_F(RecolorTest, ClusterSelectionAgreesWithReference) {
  for (const Extent extent : kOddSizes)
    for (const bool hostile : {false, true}) {
      const Pixels pixels = any_pixels(extent, 21, hostile);
      const Pixels already = random_pixels(extent, 22);  // edited before
      Layers frame = layers(extent, pixels);
      frame[Role::intrinsic] = shared_plane(extent, already);
      Recolor recolor(device, extent);
      const RecolorParams params{.cluster = 2, .clusters = 7, .texture = 0.5f};
      record(recolor, frame, params);
      const auto clusters = clusters_of(recolor, params);
      const int chosen = clusters[2].index;
      std::vector<reference::Rgb> others;
      reference::Rgb own{};
      double key_value = 1e-3;
      for (int k = 0; k < params.clusters; ++k) {
        const auto& cluster = clusters[static_cast<size_t>(k)];
        if (cluster.index != k) continue;
        const reference::Rgb color{cluster.log_color[0], cluster.log_color[1],
                                   cluster.log_color[2]};
        if (k != chosen) others.push_back(color);
        if (k != chosen) continue;
        own = color;
        for (const double c : color) key_value += std::exp(c) / 3;
      }
      ASSERT_NO_FATAL_FAILURE(expect_pixels(
          download(frame[Role::intrinsic]),
          [&](size_t n) {
            const double selected = chosen < 0 ? 0
                                               : reference::selection(pixel_of(pixels, n), own,
                                                                      others, params.softness);
            return reference::recolor(pixel_of(already, n), selected, key_value, spec_of(params));
          },
          2e-4, hostile ? "hostile" : "random"));
    }
}

TEST_F(RecolorTest, StrengthZeroRecordsNothing) {
  Layers frame = layers({16, 16}, random_pixels({16, 16}, 3));
  const Layers before = frame;
  Recolor recolor(device, frame.extent);
  const RecolorParams params{.strength = 0};
  run([&](gpu::Commands& commands) {
    recolor.record(commands, frame, params);
    EXPECT_EQ(commands.dispatches(), 0u);
  });
  EXPECT_EQ(frame.planes, before.planes);
}

TEST_F(RecolorTest, SharedPlanesStayUnchangedAndOwnOnesAreReused) {
  const Extent extent{40, 9};
  const Pixels pixels = random_pixels(extent, 4);
  Layers frame = layers(extent, pixels);
  const PlanePtr model = frame[Role::model];
  Recolor recolor(device, extent);
  RecolorParams params{.tolerance = 3};
  record(recolor, frame, params);
  EXPECT_NE(frame[Role::intrinsic], model);
  EXPECT_EQ(download(model), pixels);
  // The second edit reuses a plane that is not in use elsewhere.
  const Plane* first = frame[Role::intrinsic].get();
  const Pixels once = download(frame[Role::intrinsic]);
  params.target = {0.9f, 0.8f, 0.1f};
  record(recolor, frame, params);
  EXPECT_EQ(frame[Role::intrinsic].get(), first);
  expect_pixels(
      download(frame[Role::intrinsic]),
      [&](size_t n) { return reference::recolor(pixel_of(once, n), spec_of(params)); }, 2e-4,
      "in place");
  // A third while a tee holds it.
  const Layers branch = frame;
  const Pixels twice = download(branch[Role::intrinsic]);
  record(recolor, frame, params);
  EXPECT_NE(frame[Role::intrinsic], branch[Role::intrinsic]);
  EXPECT_EQ(download(branch[Role::intrinsic]), twice);
}

// The pool of another thread's editor may reuse a plane at once when its last owner releases it.
TEST_F(RecolorTest, PlanesThatAnEditReplacesStayUntilItsWorkIsDone) {
  const Extent extent{40, 9};
  Layers frame = layers(extent, random_pixels(extent, 4));
  frame[Role::mask] = shared_plane(extent, random_pixels(extent, 5));
  PlanePtr branch = frame[Role::intrinsic] = shared_plane(extent, random_pixels(extent, 6));
  const std::weak_ptr<Plane> mask = frame[Role::mask], intrinsic = branch;
  Recolor recolor(device, extent);
  gpu::Commands commands(device);
  commands.begin();
  recolor.record(commands, frame, {.use_mask = true, .write_mask = true});
  branch.reset();
  EXPECT_FALSE(mask.expired());
  EXPECT_FALSE(intrinsic.expired());
  commands.submit();
  commands.wait();
  EXPECT_TRUE(mask.expired());
  EXPECT_TRUE(intrinsic.expired());
}

TEST_F(RecolorTest, ExtremeParametersGiveFinitePictures) {
  using Limits = std::numeric_limits<float>;
  const Extent extent{33, 5};
  const Pixels pixels = any_pixels(extent, 2, true);
  for (const float absurd : {kNan, kInf, -kInf, -1.0f, Limits::max(), 0.0f, Limits::denorm_min()}) {
    const RecolorParams params{.key = {absurd, absurd, absurd},
                               .tolerance = absurd,
                               .value_tolerance = absurd,
                               .softness = absurd,
                               .target = {absurd, absurd, absurd},
                               .texture = absurd,
                               .brightness = absurd,
                               .hue_shift = absurd,
                               .write_mask = true};
    Layers frame = layers(extent, pixels);
    run_recolor(frame, params);
    for (const Role role : {Role::intrinsic, Role::mask})
      ASSERT_TRUE(all_finite(download(frame[role]))) << "parameters " << absurd;
  }
}

}  // namespace inverse::testing
