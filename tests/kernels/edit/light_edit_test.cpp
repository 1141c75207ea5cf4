// SPDX-License-Identifier: LGPL-2.1-or-later
// Light with layers: edits, pictures and composing against their specification.
#include "tests/reference/edit/light_edit.hpp"

#include "kernels/edit/compose.hpp"
#include "kernels/edit/light_edit.hpp"
#include "kernels/edit/recolor.hpp"
#include "kernels/image/view/light_picture.hpp"
#include "tests/differences.hpp"
#include "tests/kernels/edit/edit_fixture.hpp"
#include "tests/reference/image/light_color.hpp"

namespace inverse::testing {

using reference::Rgb;
using reference::Rgba;

class LightEditTest : public GpuTest {
 protected:
  struct Frame {
    Pixels model, light, bases;
    std::vector<Pixels> shares;
    Layers layers;
  };
  /// Random layers with `count` base colors.
  Frame frame(Extent extent, uint32_t count, unsigned seed, bool evil = false) {
    const auto random = [&](Extent size, float high) {
      Pixels pixels = random_pixels(size, seed++, 0, high);
      return evil ? with_extremes(std::move(pixels), seed) : pixels;
    };
    Frame made;
    made.model = random(extent, 1);
    made.light = random(extent, 1.5f);
    made.bases = random_pixels({kMaxBases, 1}, seed++, 0.02f, 1);
    for (uint32_t k = 0; k < kMaxBases; ++k)
      for (int c = 0; c < 4; ++c) {
        float& b = made.bases[4 * k + c];
        b = k >= count ? 0 : c == 3 ? 1 : b;
      }
    Layers& layers = made.layers;
    layers.extent = extent;
    layers[Role::input] = shared_plane(extent, random_pixels(extent, seed++));
    layers[Role::intrinsic] = layers[Role::model] = shared_plane(extent, made.model);
    layers[Role::light] = layers[Role::model_light] = shared_plane(extent, made.light);
    for (uint32_t n = 0; 4 * n < count; ++n) {
      made.shares.push_back(random(extent, 0.3f));
      layers[indirect_role(n)] = shared_plane(extent, made.shares.back());
    }
    layers[Role::bases] = shared_plane({kMaxBases, 1}, made.bases);
    return made;
  }
  static constexpr Extent kWalls{32, 8};
  using Pixel = std::array<float, 4>;
  /// Half left, half right.
  static Pixels walls(const Pixel& left, const Pixel& right) {
    Pixels pixels;
    for (size_t n = 0; n < kWalls.pixels(); ++n) {
      const Pixel& here = n % 32 < 16 ? left : right;
      pixels.insert(pixels.end(), here.begin(), here.end());
    }
    return pixels;
  }
  /// Two walls of these (R, S), under light with these shares of two base colors.
  Layers two_walls(const std::vector<Pixel>& model, const Pixel& light, const Pixel& shares,
                   const std::vector<Pixel>& base_colors) {
    Pixels bases(4 * kMaxBases);
    for (size_t k = 0; k < 2; ++k) std::copy_n(base_colors[k].begin(), 4, &bases[4 * k]);
    Layers layers{kWalls, {}};
    layers[Role::input] = shared_plane(kWalls, random_pixels(kWalls, 2));
    layers[Role::intrinsic] = layers[Role::model] = shared_plane(kWalls, walls(model[0], model[1]));
    layers[Role::light] = layers[Role::model_light] = shared_plane(kWalls, walls(light, light));
    layers[Role::indirect] = shared_plane(kWalls, walls(shares, shares));
    layers[Role::bases] = shared_plane({kMaxBases, 1}, bases);
    return layers;
  }
  void record(Recolor& recolor, Layers& layers, const RecolorParams& params) {
    run([&](gpu::Commands& commands) { recolor.record(commands, layers, params); });
  }
  static std::vector<reference::Base> bases_of(const Pixels& pixels) {
    std::vector<reference::Base> bases;
    for (size_t k = 0; k < kMaxBases; ++k)
      bases.push_back(
          {{pixels[4 * k], pixels[4 * k + 1], pixels[4 * k + 2]}, pixels[4 * k + 3] > 0});
    return bases;
  }
  static std::vector<double> shares_of(const Frame& frame, size_t n) {
    std::vector<double> shares;
    for (const Pixels& plane : frame.shares)
      for (size_t c = 0; c < 4; ++c) shares.push_back(plane[4 * n + c]);
    return shares;
  }
  /// The light after base colors became `targets`, and the base colors, against the reference.
  void expect_edited(const Frame& frame, const std::vector<Rgb>& targets, const Pixels* matte,
                     double sent_on = 1) {
    const auto before = bases_of(frame.bases);
    const Pixels bases = download(frame.layers[Role::bases]);
    std::vector<Rgb> change(kMaxBases);
    for (size_t k = 0; k < kMaxBases; ++k)
      for (size_t c = 0; c < 3; ++c) {
        change[k][c] = sent_on * (targets[k][c] - before[k].color[c]);
        const double expected = matte ? before[k].color[c] : targets[k][c];
        ASSERT_NEAR(bases[4 * k + c], expected, 1e-4 * (1 + std::abs(expected))) << "base " << k;
      }
    const Pixels light = download(frame.layers[Role::light]);
    for (size_t n = 0; n < light.size() / 4; ++n) {
      auto shares = shares_of(frame, n);
      const Rgba expected = reference::retinted(pixel_of(frame.light, n), shares, change,
                                                matte ? (*matte)[4 * n] : 1);
      for (size_t c = 0; c < 4; ++c) {
        ASSERT_TRUE(std::isfinite(light[4 * n + c]));
        // A share of 65504 turns the rounding of a base color into more than that.
        double largest = 1;
        for (const double share : shares) largest = std::max(largest, reference::finite(share));
        ASSERT_NEAR(light[4 * n + c], expected[c], 3e-4 * (largest + expected[c])) << "pixel " << n;
      }
    }
  }
};

TEST_F(LightEditTest, BaseColorsChosenByKeyTurn) {
  const Rgb target{0.2, 1.1, 1.7}, key{0.9, 0.3, 0.2};
  for (const Extent extent : kOddSizes)
    for (const bool evil : {false, true})
      for (const bool with_matte : {false, true}) {
        if (extent.pixels() > 5000 && evil) continue;
        Frame made = frame(extent, extent.width % kMaxBases + 1, extent.height, evil);
        const Pixels matte_pixels = random_pixels(extent, 77);
        const Plane matte = plane(extent, matte_pixels);
        LightEdit edit(device, extent);
        run([&](gpu::Commands& commands) {
          edit.change(commands, made.layers, {{0.9f, 0.3f, 0.2f}, 0.5f, 0.6f}, {0.2f, 1.1f, 1.7f},
                      0.8f, with_matte ? &matte : nullptr);
        });
        std::vector<Rgb> targets;
        for (const auto& base : bases_of(made.bases))
          targets.push_back(
              base.exists ? reference::changed(base.color, target,
                                               0.8 * reference::chosen(base.color, key, 0.5, 0.6))
                          : base.color);
        ASSERT_NO_FATAL_FAILURE(expect_edited(made, targets, with_matte ? &matte_pixels : nullptr));
      }
}

TEST_F(LightEditTest, OneBaseColorTurns) {
  const Extent extent{31, 17};
  for (const uint32_t index : {0U, 5U, 9U, 10U, 15U, 400U}) {
    Frame made = frame(extent, 10, index);
    LightEdit edit(device, extent);
    run([&](gpu::Commands& commands) {
      edit.change(commands, made.layers, index, {0, 0, 0}, 1, nullptr);
    });
    std::vector<Rgb> targets;
    for (const auto& base : bases_of(made.bases)) targets.push_back(base.color);
    if (index < 10) targets[index] = {0, 0, 0};
    ASSERT_NO_FATAL_FAILURE(expect_edited(made, targets, nullptr));
  }
}

TEST_F(LightEditTest, LightOfRepaintedSurfacesFollowsTheirShare) {
  const Rgb key{0.5, 0.1, 0.1}, target{0.1, 0.3, 0.6};
  double most = 1;
  for (const Extent extent : kOddSizes) {
    Frame made = frame(extent, 7, extent.width);
    const Pixels selected = random_pixels(extent, 8, 0, 1.3f);
    const Plane selection = plane(extent, selected);
    LightEdit edit(device, extent);
    run([&](gpu::Commands& commands) {
      edit.repaint(commands, made.layers, {selection, {0.5f, 0.1f, 0.1f}}, {0.1f, 0.3f, 0.6f},
                   0.9f);
    });
    std::vector<Rgba> model, light;
    std::vector<double> sel;
    for (const size_t n : reference::light_sample(extent.width, extent.height)) {
      model.push_back(pixel_of(made.model, n));
      light.push_back(pixel_of(made.light, n));
      sel.push_back(selected[4 * n]);
    }
    const auto bases = bases_of(made.bases);
    const auto shares = reference::selected_shares(bases, model, sel);
    std::vector<Rgb> wanted;
    for (size_t k = 0; k < bases.size(); ++k)
      wanted.push_back(bases[k].exists
                           ? reference::repainted(bases[k].color, key, target, 0.9 * shares[k])
                           : bases[k].color);
    const double again = reference::sent_on(model, light);
    most = std::max(most, again);
    ASSERT_NO_FATAL_FAILURE(expect_edited(made, wanted, nullptr, again)) << extent.width;
  }
  EXPECT_GT(most, 1.1);
}

TEST_F(LightEditTest, SharedPlanesStayUnchanged) {
  const Extent extent{40, 9};
  Frame made = frame(extent, 6, 3);
  const Layers before = made.layers;
  LightEdit edit(device, extent);
  run([&](gpu::Commands& commands) {
    edit.change(commands, made.layers, 2, {1, 1, 1}, 1, nullptr);
  });
  EXPECT_NE(made.layers[Role::light], before[Role::light]);
  EXPECT_EQ(download(before[Role::light]), made.light);
  EXPECT_EQ(download(before[Role::bases]), made.bases);
  // The second edit reuses a plane that is not in use elsewhere.
  const Plane* first = made.layers[Role::light].get();
  run([&](gpu::Commands& commands) {
    edit.change(commands, made.layers, 3, {1, 1, 1}, 1, nullptr);
  });
  EXPECT_EQ(made.layers[Role::light].get(), first);
}

TEST_F(LightEditTest, PlanesThatAnEditReplacesStayUntilItsWorkIsDone) {
  const Extent extent{40, 9};
  Frame made = frame(extent, 6, 3);
  PlanePtr branch = made.layers[Role::light] = shared_plane(extent, made.light);
  made.layers[Role::bases] = shared_plane({kMaxBases, 1}, made.bases);
  made.layers[Role::model_bases] = nullptr;
  const std::weak_ptr<Plane> light = branch, bases = made.layers[Role::bases];
  LightEdit edit(device, extent);
  gpu::Commands commands(device);
  commands.begin();
  edit.change(commands, made.layers, 2, {1, 1, 1}, 1, nullptr);
  branch.reset();
  EXPECT_FALSE(light.expired());
  EXPECT_FALSE(bases.expired());
  commands.submit();
  commands.wait();
  EXPECT_TRUE(light.expired());
  EXPECT_TRUE(bases.expired());
}

TEST_F(LightEditTest, RecoloringASurfaceRecolorsWhatBouncesOffIt) {
  // Half red, half white surfaces; light on both is partly what bounced off the red ones.
  const Pixel light{0.7f + 0.3f * 1, 0.7f + 0.3f * 0.1f, 0.7f + 0.3f * 0.1f, 0.7f};
  const Layers layers = two_walls({{0.6f, 0.06f, 0.06f, 1}, {0.6f, 0.6f, 0.6f, 1}}, light,
                                  {0.3f, 0, 0, 0}, {{1, 0.1f, 0.1f, 1}, {1, 1, 1, 1}});
  RecolorParams params{.key = {0.6f, 0.06f, 0.06f}, .target = {0.06f, 0.06f, 0.6f}};
  enum class By { key, cluster, base };
  for (const By by : {By::key, By::cluster, By::base}) {
    Layers edited = layers;
    Recolor recolor(device, kWalls);
    params.base = by == By::base ? 0 : RecolorParams::kByKey;
    if (by == By::base) params.key = {0.1f, 0.6f, 0.1f};  // of no account
    if (by == By::cluster) {
      params.clusters = 4;
      params.cluster = 0;
      Layers probe = layers;
      record(recolor, probe, params);
      const auto clusters = Palette::read(download(recolor.palette()->colors()).data(), 4);
      for (const auto& cluster : clusters)
        if (cluster.index >= 0 && cluster.log_color[1] < cluster.log_color[0] - 1)
          params.cluster = cluster.index;
    }
    // .12 of .82 bounced, and does so again.
    const float again = 1 / (1 - 0.12F / 0.82F);
    record(recolor, edited, params);
    const Pixels now = download(edited[Role::light]), painted = download(edited[Role::intrinsic]);
    for (size_t n = 0; n < kWalls.pixels(); ++n) {
      const bool red = n % 32 < 16;
      ASSERT_NEAR(painted[4 * n], red ? 0.06f : 0.6f, 4e-3) << static_cast<int>(by);
      ASSERT_NEAR(painted[4 * n + 2], 0.6f, 4e-3) << static_cast<int>(by);
      ASSERT_NEAR(now[4 * n], 1 - 0.3f * 0.9f * again, 4e-3) << static_cast<int>(by);
      ASSERT_NEAR(now[4 * n + 1], 0.7f + 0.3f * 0.1f, 4e-3) << static_cast<int>(by);
      ASSERT_NEAR(now[4 * n + 2], 0.73f + 0.3f * 0.9f * again, 4e-3) << static_cast<int>(by);
    }
    EXPECT_FALSE(edited[Role::mask]);
  }
}

TEST_F(LightEditTest, AMissingBaseColorSelectsNothing) {
  const Extent extent{19, 7};
  Frame made = frame(extent, 3, 5);
  for (const bool global : {true, false}) {
    Layers edited = made.layers;
    if (!global) edited[Role::light] = edited[Role::bases] = edited[Role::model_bases] = nullptr;
    const Pixels before = download(edited[Role::intrinsic]);
    const RecolorParams params{.base = kMaxBases - 1, .write_mask = true};
    Recolor recolor(device, extent);
    record(recolor, edited, params);
    EXPECT_EQ(download(edited[Role::mask]), Pixels(4 * extent.pixels(), 0));
    EXPECT_EQ(download(edited[Role::intrinsic]), before);
  }
}

TEST_F(LightEditTest, SurfacesOfABaseColorAreSelectedAndKeyed) {
  unsigned selected = 0;
  for (const Extent extent : kOddSizes)
    for (const int base : {0, 3, 6}) {
      Frame made = frame(extent, 7, extent.width + static_cast<unsigned>(base));
      const RecolorParams params{
          .base = base, .softness = 0.6F, .texture = 0.7F, .write_mask = true};
      Layers edited = made.layers;
      Recolor recolor(device, extent);
      record(recolor, edited, params);
      const Pixels mask = download(edited[Role::mask]), now = download(edited[Role::intrinsic]);
      const auto bases = bases_of(made.bases);
      std::vector<Rgba> sample;
      for (const size_t n : reference::light_sample(extent.width, extent.height))
        sample.push_back(pixel_of(made.model, n));
      const Rgb key = reference::base_key(sample, bases, size_t(base), 0.6);
      reference::RecolorSpec spec;
      for (size_t c = 0; c < 3; ++c) spec.target[c] = params.target[c];
      spec.texture = 0.7F;
      for (size_t n = 0; n < extent.pixels(); ++n) {
        const Rgba pixel = pixel_of(made.model, n);
        const double want = reference::base_selection(pixel, bases, size_t(base), 0.6);
        ASSERT_NEAR(mask[4 * n], want, 2e-3) << extent.width << " pixel " << n;
        selected += want > 0.5;
        const Rgba painted =
            reference::recolor(pixel, want, (key[0] + key[1] + key[2]) / 3 + 1e-3, spec);
        for (size_t c = 0; c < 4; ++c)
          ASSERT_NEAR(now[4 * n + c], painted[c], 4e-3 * (1 + std::abs(painted[c])))
              << extent.width << " pixel " << n;
      }
    }
  EXPECT_GT(selected, 100U);
}

TEST_F(LightEditTest, RecoloringAndBackPreservesTheLight) {
  // Two walls; one is painted blue, and red again.
  const Pixel light{0.5F + 0.3F + 0.02F, 0.5F + 0.03F + 0.02F, 0.5F + 0.03F + 0.2F, 0.5F};
  Layers layers = two_walls({{0.6F, 0.05F, 0.05F, 1}, {0.05F, 0.05F, 0.5F, 1}}, light,
                            {0.3F, 0.2F, 0, 0}, {{1, 0.1F, 0.1F, 1}, {0.1F, 0.1F, 1, 1}});
  layers[Role::model_bases] = layers[Role::bases];
  // Only the left wall, whatever it looks like.
  layers[Role::mask] = shared_plane(kWalls, walls({1, 0, 0, 0}, {}));
  RecolorParams params{.tolerance = 0.5F};
  Recolor recolor(device, kWalls);
  for (const bool back : {false, true}) {
    params.key = back ? std::array{0.05F, 0.05F, 0.6F} : std::array{0.6F, 0.05F, 0.05F};
    params.target = back ? std::array{0.6F, 0.05F, 0.05F} : std::array{0.05F, 0.05F, 0.6F};
    record(recolor, layers, params);
  }
  EXPECT_LE(max_difference(download(layers[Role::light]), walls(light, light)), 9e-3);
}

TEST_F(LightEditTest, ComposeMultipliesByTheColorOfLight) {
  for (const Extent extent : kOddSizes) {
    Frame made = frame(extent, 3, 5);
    const Pixels input = download(made.layers[Role::input]);
    const Pixels light = random_pixels(extent, 6, 0, 2);
    Compose compose(device, extent);
    run([&](gpu::Commands& commands) {
      EXPECT_EQ(compose.record(commands, made.layers, {}), made.layers[Role::input]);
    });
    made.layers[Role::light] = shared_plane(extent, light);
    for (const Residual residual : {Residual::add, Residual::ratio, Residual::none}) {
      const Pixels got = result_of([&](gpu::Commands& commands) {
        return compose.record(commands, made.layers, {residual, 1});
      });
      for (size_t n = 0; n < extent.pixels(); ++n) {
        Rgba before = pixel_of(made.model, n), now = before;
        for (size_t c = 0; c < 3; ++c) {
          before[c] *= made.light[4 * n + c];
          now[c] *= light[4 * n + c];
        }
        const Rgba wanted = reference::compose(pixel_of(input, n), before, now,
                                               static_cast<reference::Residual>(residual), 1);
        for (size_t c = 0; c < 4; ++c)
          ASSERT_NEAR(got[4 * n + c], wanted[c], 1e-5 * (1 + wanted[c])) << n;
      }
    }
  }
}

TEST_F(LightEditTest, PicturesShowTheLayers) {
  using What = LightPicture::What;
  for (const Extent extent : kOddSizes)
    for (const bool evil : {false, true}) {
      const Frame made = frame(extent, 6, 9, evil);
      const LightPicture pictures(device);
      const Plane target = plane(extent, Pixels(4 * extent.pixels()));
      for (const What what : {What::all, What::direct, What::indirect, What::layer})
        for (const uint32_t base : {0U, 5U, 7U, 12U}) {
          if (what != What::layer && base > 0) continue;
          run([&](gpu::Commands& commands) {
            pictures.record(commands, made.layers, what, target, base);
          });
          const Pixels got = download(target);
          for (size_t n = 0; n < extent.pixels(); ++n) {
            const double s = reference::finite(made.model[4 * n + 3]);
            const Rgba l = reference::finite(pixel_of(made.light, n));
            for (size_t c = 0; c < 3; ++c) {
              double wanted = what == What::all      ? l[c]
                              : what == What::direct ? l[3]
                                                     : std::max(l[c] - l[3], 0.0);
              if (what == What::layer)
                wanted = base < 6 ? made.bases[4 * base + c] *
                                        reference::finite(made.shares[base / 4][4 * n + base % 4])
                                  : 0;
              wanted = std::min(s * wanted, 65504.0);
              ASSERT_NEAR(got[4 * n + c], wanted, 1e-5 * (1 + wanted)) << n << " of " << base;
            }
          }
        }
    }
}

TEST_F(LightEditTest, ShadingHasTheColorOfItsLight) {
  const Extent extent{37, 22};
  Pixels layers = random_pixels(extent, 4, 0, 3);
  const float values[] = {0, kNan, kInf, -1, 1e-20F, 70000};
  for (size_t n = 0; n < std::size(values); ++n) layers[4 * n + 3] = values[n];
  const reference::LightColor light{-0.8, 0, 0.2};
  Layers frame{extent, {}};
  frame[Role::intrinsic] = shared_plane(extent, layers);
  frame[Role::slope] = shared_plane({1, 1}, {float(light.slope), float(light.white), 1, 0});
  const Plane target = plane(extent);
  run([&](gpu::Commands& commands) {
    LightPicture(device).record(commands, frame, LightPicture::What::all, target);
  });
  const Pixels got = download(target);
  for (size_t n = 0; n < extent.pixels(); ++n) {
    const double s = reference::finite(double(layers[4 * n + 3]));
    const Rgba gray = reference::in_gray_light({1, 1, 1, s}, light);
    for (size_t c = 0; c < 3; ++c) {
      const double wanted = std::min(s * gray[c], 65504.0);
      ASSERT_NEAR(got[4 * n + c], wanted, 2e-5 * (1 + wanted)) << n;
    }
  }
}

}  // namespace inverse::testing
