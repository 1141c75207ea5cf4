// SPDX-License-Identifier: LGPL-2.1-or-later
// The network that relights against its equations, its files, and few lights in place of many.
#include "kernels/lightstage/network/relight_network.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "kernels/lightstage/lights/light_reduction.hpp"
#include "kernels/lightstage/lights/measured_light.hpp"
#include "kernels/lightstage/relighting.hpp"
#include "reflectance_field_fixture.hpp"
#include "relight_models.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

using reference::dot, reference::Vec3;

class RelightNetworkTest : public ReflectanceFieldTest {
 protected:
  void SetUp() override {
    GpuTest::SetUp();
    use_stage(geodesic_directions(42));
  }
  /// Two frames as a camera gives them.
  struct Frame {
    Extent extent;
    Pixels a, b;
  };
  static Frame frame(Extent extent, unsigned seed) {
    return {extent, random_pixels(extent, seed, 0, .5F), random_pixels(extent, seed + 1, 0, .5F)};
  }
  /// A subject that two frames show, and how it looks under lights.
  struct Subject {
    RelightNetworkTest& test;
    CosineLobe lobes;
    RelightNetwork network;
    Plane a, b, target;

    void record(gpu::Commands& commands) {
      lobes.record_lobes(commands, {a, b}, {});
      network.record_features(commands, {a, b});
    }
    Pixels under(std::span<const WeightedLight> lights, double share,
                 const MeasuredLight& measured = {}, float noise = CosineLobe::Params{}.noise) {
      test.run([&](gpu::Commands& commands) {
        record(commands);
        network.record_sum(commands, *lobes.full(), lights, share, target, measured, noise);
      });
      return test.download(target);
    }
  };
  Subject subject(const RelightModels& models, const Frame& f) {
    return {*this,
            lobe_method(f.extent),
            RelightNetwork(device, f.extent, models),
            plane(f.extent, f.a),
            plane(f.extent, f.b),
            plane(f.extent)};
  }
};

RelightModels random_models(unsigned seed) {
  return RelightModels::of(random_features(seed), random_light(seed + 100), "light");
}

}  // namespace

TEST_F(RelightNetworkTest, EveryLightFollowsTheEquations) {
  const RelightModels models = random_models(1);
  const Frame f = frame({64, 32}, 3);
  Subject relit = subject(models, f);
  std::mt19937 random(5);
  for (const size_t count : {1u, 3u, 4u, 9u}) {
    std::vector<WeightedLight> lights;
    std::vector<reference::Plane> single;
    for (size_t i = 0; i < count; ++i) {
      const Vec3 w = any_direction(random);
      lights.push_back({w, {1, .5F + static_cast<float>(i), .25F}});
      single.push_back(reference::network_light(models, to_reference(f.extent, f.a),
                                                to_reference(f.extent, f.b), w));
    }
    const Pixels got = relit.under(lights, .125);
    for (size_t i = 0; i < f.extent.pixels(); ++i) {
      for (size_t c = 0; c < 3; ++c) {
        double expected = 0;
        for (size_t k = 0; k < count; ++k)
          expected += .125 * lights[k].weight[c] * single[k].data[i][c];
        ASSERT_NEAR(got[4 * i + c], expected, 2e-4 * expected + 1e-4) << count << " " << i;
      }
      ASSERT_EQ(got[4 * i + 3], f.a[4 * i + 3]);
    }
  }
}

TEST_F(RelightNetworkTest, WhatWasMeasuredComesOnTop) {
  const Frame f = frame({40, 32}, 33);
  Subject relit = subject(random_models(31), f);
  const MeasuredLight light{{.5F, -.25F, 1}, {Rgb{1, .5F, 0}, Rgb{0, -1, .25F}, Rgb{.125F, 0, -2}}};
  reference::Measured expected{{.5, -.25, 1}, {{1, .5, 0}, {0, -1, .25}, {.125, 0, -2}}};
  const WeightedLight lamp{{0, 0, 1}, {1, 1, 1}};
  for (const size_t lamps : {0u, 1u}) {
    const std::span lit(&lamp, lamps);
    const Pixels alone = relit.under(lit, .25), got = relit.under(lit, .25, light, .02F);
    for (size_t i = 0; i < f.extent.pixels(); ++i) {
      const Vec3 one{f.a[4 * i], f.a[4 * i + 1], f.a[4 * i + 2]},
          two{f.b[4 * i], f.b[4 * i + 1], f.b[4 * i + 2]};
      const Vec3 measured = reference::measured_picture(expected, one, two, .02);
      for (size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(got[4 * i + c], std::max(0.0, alone[4 * i + c] + measured[c]), 1e-5);
    }
  }
}

TEST_F(RelightNetworkTest, TheStagesOwnLightComesBackAsItWasSeen) {
  // Whatever the network predicts: under gradient A nothing is left for it.
  const Frame f = frame({32, 32}, 41);
  Subject relit = subject(random_models(43), f);
  for (const double sign : {1., -1.}) {
    std::vector<Rgb> weights;
    std::vector<WeightedLight> rest;
    for (const Vec3& w : directions) {
      weights.emplace_back();
      for (size_t c = 0; c < 3; ++c) weights.back()[c] = static_cast<float>((1 + sign * w[c]) / 2);
    }
    const SplitLight split = SplitLight::of(directions, weights);
    for (size_t i = 0; i < directions.size(); ++i) {
      for (const float r : split.rest[i]) ASSERT_NEAR(r, 0, 1e-5);
      rest.push_back({directions[i], split.rest[i]});
    }
    const Pixels got = relit.under(rest, 1. / 42, split.measured, 1e-4F);
    for (size_t i = 0; i < got.size(); ++i)
      if (i % 4 != 3) {
        ASSERT_NEAR(got[i], sign > 0 ? f.a[i] : f.b[i], 1e-3);
      }
  }
}

TEST(SplitLight, IsAsSpecified) {
  std::mt19937 random(47);
  std::normal_distribution<float> normal;
  const float huge = 1e12F;
  for (const size_t count : {1u, 3u, 42u, 331u})
    for (const float spread : {0.F, .5F, 2.F, 5.F})
      for (const float scale : {1e-12F, 1.F, huge}) {
        const auto lights = geodesic_directions(std::max<size_t>(count, 12));
        const std::vector<Vec3> few(lights.begin(), lights.begin() + static_cast<long>(count));
        std::vector<Rgb> weights;
        std::vector<reference::Lamp> lamps;
        for (const Vec3& w : few) {
          weights.push_back({});
          for (float& v : weights.back()) v = scale * std::exp(spread * normal(random));
          lamps.push_back({w, {weights.back()[0], weights.back()[1], weights.back()[2]}});
        }
        const SplitLight got = SplitLight::of(few, weights);
        const auto expected = reference::measured_light(lamps);
        for (size_t c = 0; c < 3; ++c) {
          double mean = 0;
          for (const Rgb& w : weights) mean += double{w[c]} / static_cast<double>(count);
          if (count >= 4) {  // fewer leave directions open
            EXPECT_NEAR(got.measured.even[c] / mean, expected.even[c] / mean, 1e-4);
            for (size_t k = 0; k < 3; ++k)
              EXPECT_NEAR(got.measured.along[k][c] / mean, expected.along[k][c] / mean, 1e-4);
          }
          for (size_t i = 0; i < count; ++i) {
            double sum = double{got.measured.even[c]} + got.rest[i][c];
            for (size_t k = 0; k < 3; ++k) sum += got.measured.along[k][c] * few[i][k];
            EXPECT_NEAR(sum / mean, weights[i][c] / mean, 1e-4 * (1 + weights[i][c] / mean));
          }
        }
      }
}

TEST(SplitLight, GivesTheNetworkAFewBrightLights) {
  const auto lights = geodesic_directions(331);
  std::vector<Rgb> weights(331);
  weights[17] = {300, 200, 100};
  const SplitLight split = SplitLight::of(lights, weights);
  EXPECT_EQ(split.rest, weights) << "dark lights stay dark";
  EXPECT_EQ(split.measured.even, Rgb{});
  EXPECT_EQ(SplitLight::of(lights, std::vector<Rgb>(331)).rest, std::vector<Rgb>(331));
}

TEST_F(RelightNetworkTest, FramesOfAnySizeAreAsPartsOfLargerOnes) {
  const RelightModels models = random_models(7);
  const WeightedLight light{{0, 0, 1}, {1, 1, 1}};
  for (const Extent extent : {Extent{1, 1}, {33, 5}, {31, 64}}) {
    const Frame f = frame(extent, 11);
    // The last row and column go on.
    const Extent padded{(extent.width + 31) / 32 * 32, (extent.height + 31) / 32 * 32};
    reference::Plane wide_a(static_cast<int>(padded.width), static_cast<int>(padded.height));
    reference::Plane wide_b = wide_a;
    for (uint32_t y = 0; y < padded.height; ++y)
      for (uint32_t x = 0; x < padded.width; ++x) {
        const size_t from =
            std::min(y, extent.height - 1) * extent.width + std::min(x, extent.width - 1);
        for (size_t c = 0; c < 4; ++c) {
          wide_a.at(static_cast<int>(x), static_cast<int>(y))[c] = f.a[4 * from + c];
          wide_b.at(static_cast<int>(x), static_cast<int>(y))[c] = f.b[4 * from + c];
        }
      }
    const auto expected = reference::network_light(models, wide_a, wide_b, light.direction);
    const Pixels got = subject(models, f).under(std::span(&light, 1), 1);
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x)
        for (size_t c = 0; c < 3; ++c) {
          const double e = expected.at(static_cast<int>(x), static_cast<int>(y))[c];
          ASSERT_NEAR(got[4 * (size_t{y} * extent.width + x) + c], e, 3e-4 * e + 1e-4);
        }
  }
}

TEST_F(RelightNetworkTest, ResponsesAreThoseOfSingleLights) {
  const RelightModels models = random_models(13);
  const Frame f = frame({40, 20}, 17);
  CosineLobe lobes = lobe_method(f.extent);
  RelightNetwork network(device, f.extent, models);
  const Plane a = plane(f.extent, f.a), b = plane(f.extent, f.b), target = plane(f.extent);
  std::vector<uint32_t> samples{0, 799, 41};
  const auto words = upload(gpu::Element::word, samples.data(), samples.size());
  const size_t count = directions.size();  // not a multiple of four
  const auto responses = gpu::Buffer::create(device, gpu::Element::vec4, samples.size() * count);
  for (const size_t which : {size_t{0}, size_t{17}, count - 1}) {
    const WeightedLight light{directions[which], {1, 1, 1}};
    run([&](gpu::Commands& commands) {
      lobes.record_lobes(commands, {a, b}, {});
      network.record_features(commands, {a, b});
      network.record_responses(commands, *lobes.full(), directions, .25, words, responses);
      network.record_sum(commands, *lobes.full(), std::span(&light, 1), .25, target);
    });
    const Pixels got = download(responses), whole = download(target);
    for (size_t s = 0; s < samples.size(); ++s)
      for (size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(got[4 * (s * count + which) + c], whole[4 * samples[s] + c],
                    1e-5 * whole[4 * samples[s] + c] + 1e-7);
  }
}

TEST_F(RelightNetworkTest, NonFiniteInputIsIgnored) {
  const Extent extent{32, 32};
  Pixels bad(extent.pixels() * 4);
  const std::array<float, 6> values{kNan, kInf, -kInf, -1, 0, 1e38F};
  for (size_t i = 0; i < bad.size(); ++i) bad[i] = values[(i * 7 + i / 5) % values.size()];
  const WeightedLight light{{1, 0, 0}, {1, 1, 1}};
  EXPECT_TRUE(
      all_finite(subject(random_models(19), {extent, bad, bad}).under(std::span(&light, 1), 1)));
}

TEST(RelightModels, RefusesOtherNetworksByName) {
  const TemporaryFolder folder;
  const auto load = [&] { return error_of([&] { RelightModels::load(folder.path()); }); };
  expect_contains(load(), "features.net");
  write_graph(random_features(1), folder / "features.net");
  expect_contains(load(), "light.net");
  write_graph(random_light(2), folder / "light.net");
  EXPECT_EQ(load(), "");
  for (const auto& [in, hidden, out] : {std::tuple{23u, 24u, 4u}, {24u, 16u, 4u}, {24u, 24u, 3u}}) {
    write_graph(random_light(2, in, hidden, out), folder / "light.net");
    expect_contains(load(), "layer \"node ");
  }
  write_graph(random_light(2), folder / "light.net");
  write_graph(random_features(1, 3), folder / "features.net");
  expect_contains(load(), "features.net");
  write_graph(random_features(1, 6, 32), folder / "features.net");
  expect_contains(load(), "32 channels");
  // Weights that are no numbers, and files that end early.
  network::Graph sick = random_features(1);
  sick.weights[40] = kNan;
  write_graph(sick, folder / "features.net");
  expect_contains(load(), "node 0");
  write_graph(random_features(1), folder / "features.net");
  std::filesystem::resize_file(folder / "features.net", 1000);
  expect_contains(load(), "features.net");
}

TEST_F(RelightNetworkTest, WithoutANetworkThereIsAnErrorAndNoCrash) {
  const auto stage_of = std::make_shared<const RelightStage>(directions);
  Relighting method(device, {16, 16}, stage_of, nullptr);
  method.set_environment(LightCells::map(Environment::studio()));
  const Relighting::Params params{.model = Relighting::Model::network};
  const Plane a = plane({16, 16}, Pixels(16 * 16 * 4, .25F));
  run([&](gpu::Commands& commands) {
    expect_error(ErrorKind::internal, "no network was loaded to relight with", [&] {
      method.record_pair(commands, {a, a}, params, 0, false, true);
    });
  });
}

TEST_F(RelightNetworkTest, FewLightsStayWithinTheirPredictedError) {
  use_stage(geodesic_directions(331));
  const auto stage_of = std::make_shared<const RelightStage>(directions);
  const RelightModels models = random_models(23);
  // A scene with edges and shades: the network's answers differ from place to place.
  const Extent extent{96, 64};
  Pixels pa(extent.pixels() * 4), pb(extent.pixels() * 4);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const Vec3 n{std::sin(.11 * x), std::sin(.17 * y), 1};
      const double size = std::sqrt(dot(n, n));
      const double albedo = (x / 12 + y / 9) % 2 ? .8 : .3;
      for (size_t c = 0; c < 3; ++c) {
        const double m = 2. / 3 * n[c] / size;
        pa[4 * (y * extent.width + x) + c] = static_cast<float>(albedo * (1 + m) / 2);
        pb[4 * (y * extent.width + x) + c] = static_cast<float>(albedo * (1 - m) / 2);
      }
    }
  const Plane a = plane(extent, pa), b = plane(extent, pb), target = plane(extent);
  for (const float max_error : {.03F, .01F}) {
    Relighting method(device, extent, stage_of, &models);
    method.set_environment(LightCells::map(Environment::studio()));
    Relighting::Params params{.model = Relighting::Model::network, .max_error = max_error};
    const auto relit = [&](uint64_t number) {
      run([&](gpu::Commands& commands) {
        method.record_pair(commands, {a, b}, params, number, false, true);
        method.record_relit(commands, params, target);
      });
      return download(target);
    };
    const Pixels whole = relit(0);
    EXPECT_EQ(method.stats().evaluated, method.stats().lit) << "nothing is known yet";
    for (uint64_t number = 1; number < 4; ++number) relit(number);
    const Pixels few = relit(4);
    const auto evaluated = method.stats().evaluated;
    double off = 0, total = 0;
    for (size_t i = 0; i < whole.size(); ++i) {
      if (i % 4 == 3) continue;
      off += std::fabs(whole[i] - few[i]);
      total += whole[i];
    }
    printf("max-error %.3f: %d of %d lights, expected error %.4f, true %.4f\n",
           static_cast<double>(max_error), static_cast<int>(evaluated),
           static_cast<int>(method.stats().lit), method.stats().expected_error, off / total);
    EXPECT_LT(evaluated, method.stats().lit / 3);
    EXPECT_LE(method.stats().expected_error, max_error);
    EXPECT_LT(off / total, 1.5 * max_error) << "as samples tell it";
    params.adaptive = false;
    EXPECT_EQ(relit(5), whole);
    EXPECT_EQ(method.stats().evaluated, method.stats().lit);
  }
}

TEST(LightReduction, WithoutSamplesItTakesAllLights) {
  const auto lights = geodesic_directions(42);
  LightReduction reduction(lights);
  std::vector<Rgb> weights(42, Rgb{1, 2, 3});
  weights[7] = {0, 0, 0};
  EXPECT_EQ(reduction.choose(weights, weights, .5).lights.size(), 41u);
  reduction.set_responses(std::vector<float>(4 * 42 * 100, 0.0F));
  EXPECT_FALSE(reduction.ready()) << "black samples say nothing";
  reduction.set_responses(std::vector<float>(4 * 42 * 100, kNan));
  EXPECT_FALSE(reduction.ready());
  reduction.set_responses(std::vector<float>(4 * 42 * 100, 1.0F));
  EXPECT_TRUE(reduction.ready());
  const auto choice = reduction.choose(weights, weights, .01);
  EXPECT_EQ(choice.lights.size(), 1u) << "all lights do the same";
  EXPECT_NEAR(choice.lights[0].weight[1], 2 * 41, 1e-2);
  EXPECT_LT(reduction.error(choice, weights, weights), 1e-4);
  EXPECT_EQ(reduction.choose(weights, weights, 0).lights.size(), 41u);
  EXPECT_TRUE(reduction.choose(std::vector<Rgb>(42), std::vector<Rgb>(42), .01).lights.empty())
      << "it is dark";
}

}  // namespace inverse::testing
