// The thesis' global decomposition on the device against the double-precision reference.
#include "global_thesis/global_thesis.hpp"

#include <algorithm>
#include <limits>

#include "../reference/global_thesis_params.hpp"
#include "gpu_fixture.hpp"

namespace inverse::testing {
namespace {

using Rgb = GlobalThesis::Rgb;

/// A red and a blue wall and a light floor between, lit from above; each wall's light falls on the
/// floor. Noise of `amplitude`; `shift` moves the walls.
Pixels room(Extent extent, unsigned seed, uint32_t shift = 0, float amplitude = 0.01f) {
  const float colors[][3] = {{1.0f, 0.25f, 0.2f}, {0.9f, 0.9f, 0.88f}, {0.25f, 0.5f, 1.0f}};
  const Pixels noise = random_pixels(extent, seed, -amplitude, amplitude);
  Pixels pixels(extent.pixels() * 4, 1.0f);
  for (uint32_t y = 0; y < extent.height; ++y) {
    for (uint32_t x = 0; x < extent.width; ++x) {
      const size_t n = 4 * (static_cast<size_t>(y) * extent.width + x);
      const float u =
          static_cast<float>((x + shift) % extent.width) / static_cast<float>(extent.width);
      const float v = static_cast<float>(y) / static_cast<float>(extent.height);
      const size_t wall = u < 0.3f ? 0 : (u < 0.7f ? 1 : 2);
      const float direct = (3 * x + y) % 131 < 40 ? 0.2f : 0.3f + 0.4f * v;
      for (size_t c = 0; c < 3; ++c) {
        const float light = direct + 0.3f * std::exp(-5 * u) * colors[0][c] +
                            0.3f * std::exp(-5 * (1 - u)) * colors[2][c];
        pixels[n + c] = std::max(colors[wall][c] * light + noise[n + c], 0.0f);
      }
    }
  }
  return pixels;
}

std::vector<Rgb> random_colors(size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(0.05f, 1.0f);
  std::vector<Rgb> colors(count);
  for (Rgb& color : colors) color = {value(random), value(random), value(random)};
  return colors;
}

reference::Vec3 to_reference(const Rgb& color) {
  return {static_cast<double>(color[0]), static_cast<double>(color[1]),
          static_cast<double>(color[2])};
}

std::vector<reference::Vec3> to_reference(const std::vector<Rgb>& colors) {
  std::vector<reference::Vec3> result;
  for (const Rgb& color : colors) result.push_back(to_reference(color));
  return result;
}

/// The device's field, plane behind plane, in the reference's order.
reference::GlobalField to_field(Extent extent, size_t layers, const Pixels& planes) {
  reference::GlobalField field(static_cast<int>(extent.width), static_cast<int>(extent.height),
                               layers);
  for (size_t n = 0; n < extent.pixels(); ++n) {
    for (size_t i = 0; i < field.unknowns; ++i) {
      const size_t plane = i / 4;
      field.at(n)[i] = static_cast<double>(planes[4 * (plane * extent.pixels() + n) + i % 4]);
    }
  }
  return field;
}

}  // namespace

class GlobalThesisTest : public GpuTest {
 protected:
  /// Which cluster the device gave each pixel, as the reference takes it.
  reference::Plane targets_of(const GlobalThesis& method, Extent extent, float weight) {
    reference::Plane targets = testing::to_reference(extent, download(method.targets()));
    for (reference::Vec4& target : targets.data) target[3] = target[3] == weight && weight > 0;
    return targets;
  }

  /// Feeds the same frames to both and compares every frame's solution and energy.
  void compare(Extent extent, GlobalThesisParams params, const std::vector<Pixels>& frames,
               const std::vector<Rgb>& colors, double tolerance = 1e-3) {
    params.energy = true;
    params.refine_rounds = 0;
    GlobalThesis method(device, extent);
    method.set_params(params);
    method.set_base_colors(colors);
    reference::GlobalThesis expected(testing::to_reference(params));
    const std::vector<reference::Vec3> layers = to_reference(method.colors().layer_colors());
    for (size_t t = 0; t < frames.size(); ++t) {
      const Plane frame = plane(extent, frames[t]);
      uint64_t number = 0;
      GlobalThesis::Output output;
      run([&](gpu::Commands& commands) { number = method.record(commands, frame, output); });
      method.collect(number);
      const auto stats = method.stats(number);
      ASSERT_EQ(stats.layers, static_cast<int>(colors.size()));
      const Pixels planes = download(method.solution());
      for (const float value : planes) ASSERT_TRUE(std::isfinite(value));
      const reference::GlobalField got = to_field(extent, colors.size(), planes);

      const Pixels features = download(method.features());
      reference::Plane chromaticities(static_cast<int>(extent.width),
                                      static_cast<int>(extent.height));
      for (size_t n = 0; n < extent.pixels(); ++n)
        chromaticities.data[n][3] = static_cast<double>(features[4 * n]);
      expected.set_chromaticities(chromaticities);
      const reference::Plane image = testing::to_reference(extent, frames[t]);
      const reference::GlobalField x =
          expected.decompose(image, targets_of(method, extent, params.lambda_clustering), layers);
      double worst = 0;
      for (size_t i = 0; i < x.data.size(); ++i)
        worst = std::max(worst, std::abs(got.data[i] - x.data[i]));
      const double reference_energy = expected.energy(x).total();
      const double energy = expected.energy(got).total();
      const std::string where = std::to_string(extent.width) + "x" + std::to_string(extent.height) +
                                ", K " + std::to_string(colors.size()) + ", frame " +
                                std::to_string(t);
      EXPECT_LT(worst, tolerance) << where;
      EXPECT_NEAR(energy, reference_energy, 0.01 * reference_energy + 1e-5) << where;
      ASSERT_EQ(stats.energy.size(), 1u);
      EXPECT_NEAR(stats.energy[0].total(), energy, 1e-3 * energy + 1e-3) << where;
      printf("  %s: max |dx| %.2e, energy %.6g against %.6g\n", where.c_str(), worst, energy,
             reference_energy);
    }
  }
};

const std::vector<Rgb> kRoom = {{1.0f, 0.25f, 0.2f}, {0.25f, 0.5f, 1.0f}, {0.9f, 0.9f, 0.88f}};
const std::vector<Extent> kSizes = {{1, 1}, {2, 3}, {1, 40}, {17, 5}, {15, 10}, {64, 48}};

TEST_F(GlobalThesisTest, AgreesWithReference) {
  for (const Extent extent : kSizes) compare(extent, {}, {room(extent, extent.width)}, kRoom);
}

TEST_F(GlobalThesisTest, AnyNumberOfLayersAgreesWithReference) {
  const Extent extent{37, 21};
  for (const size_t count : {0, 1, 4, 5, 8, 10, 13, 16})
    compare(extent, {}, {room(extent, 3)}, random_colors(count, 7));
}

TEST_F(GlobalThesisTest, LargerFrameAgreesWithReference) {
  GlobalThesisParams params;
  params.steps = 3;
  compare({349, 287}, params, {room({349, 287}, 1)}, kRoom);
  compare({8192, 16}, params, {room({8192, 16}, 2)}, random_colors(6, 1));
}

TEST_F(GlobalThesisTest, RandomPixelsAgreeWithReference) {
  for (const Extent extent : {Extent{17, 5}, Extent{67, 49}})
    compare(extent, {}, {random_pixels(extent, 5)}, random_colors(10, 2), 0.05);
}

TEST_F(GlobalThesisTest, KeyframesAgreeWithReference) {
  const Extent extent{40, 30};
  std::vector<Pixels> frames;
  for (uint32_t t = 0; t < 9; ++t) frames.push_back(room(extent, t, 2 * t));
  GlobalThesisParams params;
  params.keyframe_spacing = 1;
  compare(extent, params, frames, kRoom);
  params.resample = true;
  params.keyframes = 2;
  params.keyframe_spacing = 2;
  compare(extent, params, frames, kRoom);
  params.keyframes = 0;
  compare(extent, params, {frames[0], frames[1]}, kRoom);
}

TEST_F(GlobalThesisTest, EveryParameterReachesTheEnergy) {
  const Extent extent{33, 21};
  using Set = void (*)(GlobalThesisParams&);
  for (const Set set : {
           Set([](GlobalThesisParams& p) { p.irls = GlobalThesisParams::Irls::printed; }),
           Set([](GlobalThesisParams& p) { p.p = 0.5f; }),
           Set([](GlobalThesisParams& p) { p.p = 2.0f; }),
           Set([](GlobalThesisParams& p) { p.lambda_data = 300, p.lambda_clustering = 0; }),
           Set([](GlobalThesisParams& p) { p.lambda_r_sparsity = 2, p.lambda_r_consistency = 90; }),
           Set([](GlobalThesisParams& p) { p.lambda_monochrome = 300, p.alpha_sr = 3; }),
           Set([](GlobalThesisParams& p) { p.lambda_i_sparsity = 40, p.lambda_smoothness = 0; }),
           Set([](GlobalThesisParams& p) { p.lambda_smoothness = 30; }),
           Set([](GlobalThesisParams& p) { p.lambda_non_negativity = 0; }),
           Set([](GlobalThesisParams& p) { p.samples = 20, p.tau_cc = 0.4f, p.seed = 77; }),
           Set([](GlobalThesisParams& p) { p.lambda_r_consistency = 0, p.w_intensity = 0.2f; }),
           Set([](GlobalThesisParams& p) { p.steps = 3, p.pcg_iterations = 5; }),
           Set([](GlobalThesisParams& p) { p.epsilon = 0.03f, p.epsilon_r = 0.05f; }),
           Set([](GlobalThesisParams& p) { p.log_floor = 0.05f, p.chroma_floor = 0.1f; }),
           Set([](GlobalThesisParams& p) { p.indirect_start = 0.7f; }),
       }) {
    GlobalThesisParams params;
    set(params);
    compare(extent, params, {room(extent, 3)}, kRoom, 5e-3);
  }
}

// Base colors that cannot be told apart or give no light, and pictures with nothing to find.
TEST_F(GlobalThesisTest, DegenerateScenesAgreeWithReference) {
  const Extent extent{37, 21};
  const std::vector<std::vector<Rgb>> palettes = {
      {{1, 1, 1}},                                              // white
      {{0, 0, 0}},                                              // black
      {{1, 0.2f, 0.1f}, {1, 0.2f, 0.1f}, {1, 0.2f, 0.1f}},      // identical
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {0, 0, 0}},  // primaries
  };
  Pixels gray = random_pixels(extent, 1, 0.3f, 0.6f);
  Pixels saturated = room(extent, 1);
  Pixels noise = random_pixels(extent, 2, 0.0f, 0.05f);
  for (size_t n = 0; n < extent.pixels(); ++n) {
    for (size_t c = 1; c < 3; ++c) gray[4 * n + c] = gray[4 * n];
    if (n % 37 > 12 && n % 37 < 25)
      for (size_t c = 0; c < 3; ++c) saturated[4 * n + c] = 1.0f;
  }
  for (const auto& colors : palettes) {
    for (const Pixels& pixels : {gray, saturated, noise, Pixels(extent.pixels() * 4, 0.0f),
                                 Pixels(extent.pixels() * 4, 1.0f)}) {
      compare(extent, {}, {pixels}, colors, 0.02);
    }
  }
}

TEST_F(GlobalThesisTest, ExtremeInputStaysFinite) {
  const float inf = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Extent extent : {Extent{1, 1}, Extent{2, 3}, Extent{37, 21}}) {
    for (const size_t count : {0, 3, 16}) {
      GlobalThesis method(device, extent);
      if (count > 0) method.set_base_colors(random_colors(count, 4));
      for (const float fill : {0.0f, 1.0f, 0.5f, 1.0f / 255, -3.0f, 1e4f, inf, -inf, nan}) {
        for (const bool hot : {false, true}) {
          Pixels pixels(extent.pixels() * 4, fill);
          if (hot) pixels[4 * (extent.pixels() / 2)] = 1e4f;
          const Plane frame = plane(extent, pixels);
          GlobalThesis::Output output;
          uint64_t number = 0;
          run([&](gpu::Commands& commands) { number = method.record(commands, frame, output); });
          method.collect(number);
          std::vector<PlanePtr> planes = output.indirect;
          planes.insert(planes.end(), {output.intrinsic, output.direct});
          for (const PlanePtr& layer : planes) {
            for (const float value : download(layer->buffer)) {
              ASSERT_TRUE(std::isfinite(value)) << fill << (hot ? " with a hot pixel" : "");
              ASSERT_GE(value, 0.0f);
            }
          }
        }
      }
    }
  }
}

TEST_F(GlobalThesisTest, ExtremeParametersStayFinite) {
  const Extent extent{37, 21};
  const Plane frame = plane(extent, room(extent, 1));
  GlobalThesis method(device, extent);
  method.set_base_colors(kRoom);
  const float huge = std::numeric_limits<float>::max();
  for (const float p : {-1.0f, 0.0f, 2.0f, 9.0f}) {
    for (const float weight : {-1.0f, 0.0f, 1e-6f, 1e6f, huge}) {
      for (const bool data : {false, true}) {
        GlobalThesisParams params;
        params.p = p;
        if (data) params.lambda_data = params.lambda_clustering = weight;
        params.lambda_r_sparsity = params.lambda_i_sparsity = params.lambda_smoothness = weight;
        params.lambda_non_negativity = params.lambda_monochrome = weight;
        params.lambda_ir = params.lambda_cr = weight;
        params.epsilon = params.epsilon_r = params.log_floor = params.chroma_floor = 0;
        params.alpha_sr = params.indirect_start = huge;
        params.steps = 4;
        method.set_params(params);
        method.refine();
        GlobalThesis::Output output;
        uint64_t number = 0;
        run([&](gpu::Commands& commands) { number = method.record(commands, frame, output); });
        method.collect(number);
        for (const PlanePtr& layer : {output.intrinsic, output.direct, output.indirect[0]}) {
          for (const float value : download(layer->buffer))
            ASSERT_TRUE(std::isfinite(value)) << "p " << p << ", weight " << weight;
        }
        for (const Rgb& color : method.colors().layer_colors())
          for (const float channel : color) ASSERT_TRUE(std::isfinite(channel));
      }
    }
  }
}

TEST_F(GlobalThesisTest, LayersMultiplyToTheInput) {
  const Extent extent{64, 48};
  const Pixels pixels = room(extent, 2);
  const Plane frame = plane(extent, pixels);
  GlobalThesis method(device, extent);
  method.set_base_colors(kRoom);
  GlobalThesis::Output output;
  run([&](gpu::Commands& commands) { method.record(commands, frame, output); });
  ASSERT_EQ(output.indirect.size(), 1u);
  ASSERT_EQ(output.colors.size(), 3u);
  const Pixels intrinsic = download(output.intrinsic->buffer);
  const Pixels direct = download(output.direct->buffer);
  const Pixels indirect = download(output.indirect[0]->buffer);
  double sum = 0;
  for (size_t n = 0; n < extent.pixels(); ++n) {
    double mean = 0;
    for (size_t c = 0; c < 3; ++c) {
      double s = static_cast<double>(direct[4 * n + c]);
      for (size_t k = 0; k < 3; ++k)
        s += static_cast<double>(output.colors[k][c]) * indirect[4 * n + k];
      const double e = static_cast<double>(pixels[4 * n + c]) - intrinsic[4 * n + c] * s;
      sum += e * e;
      mean += s / 3;
    }
    EXPECT_NEAR(intrinsic[4 * n + 3], mean, 1e-5);
    EXPECT_EQ(indirect[4 * n + 3], 0.0f);  // three layers
  }
  // Below one percent of the range (section 5.8).
  EXPECT_LT(std::sqrt(sum / (3.0 * static_cast<double>(extent.pixels()))), 0.01);
}

TEST_F(GlobalThesisTest, FindsTheBaseColorsAndLeavesOutWhatIsGray) {
  const Extent extent{96, 72};
  GlobalThesis method(device, extent);
  const auto decompose = [&](const Pixels& pixels, GlobalThesis::Output& output) {
    const Plane frame = plane(extent, pixels);
    uint64_t number = 0;
    run([&](gpu::Commands& commands) { number = method.record_colors(commands, frame); });
    method.collect(number);
    run([&](gpu::Commands& commands) { number = method.record(commands, frame, output); });
    method.collect(number);
    return method.stats(number);
  };
  GlobalThesis::Output output;
  const auto colored = decompose(room(extent, 1), output);
  EXPECT_GE(colored.layers, 2);
  EXPECT_GE(colored.colors, 3);
  for (const Rgb& wall : {kRoom[0], kRoom[1]}) {
    double nearest = 1;
    for (const Rgb& color : output.colors) {
      double distance = 0;
      for (size_t c = 0; c < 3; ++c)
        distance = std::max<double>(distance, std::abs(color[c] - wall[c]));
      nearest = std::min(nearest, distance);
    }
    EXPECT_LT(nearest, 0.15);
  }
  // A gray scene has one base color, white, which needs no layer: neither memory nor time.
  Pixels gray = room(extent, 1, 0, 0);
  for (size_t n = 0; n < extent.pixels(); ++n)
    for (size_t c = 1; c < 3; ++c) gray[4 * n + c] = gray[4 * n];
  method.reset();
  const auto none = decompose(gray, output);
  EXPECT_EQ(none.layers, 0);
  EXPECT_EQ(none.colors, 1);
  EXPECT_TRUE(output.indirect.empty());
}

TEST_F(GlobalThesisTest, TheFirstFrameNeedsNoColors) {
  const Extent extent{64, 48};
  GlobalThesis method(device, extent);
  const Plane frame = plane(extent, room(extent, 1));
  std::vector<int> layers;
  for (int t = 0; t < 3; ++t) {
    GlobalThesis::Output output;
    uint64_t number = 0;
    run([&](gpu::Commands& commands) { number = method.record(commands, frame, output); });
    layers.push_back(method.stats(number).layers);
    method.collect(number);
  }
  EXPECT_EQ(layers[0], 0);
  EXPECT_GE(layers[1], 2);
  EXPECT_EQ(layers[2], layers[1]);
}

TEST_F(GlobalThesisTest, RefinementAgreesWithReference) {
  const Extent extent{48, 36};
  for (const size_t count : {1, 3, 6, 16}) {
    GlobalThesisParams params;
    params.samples = 0;
    params.refine_rounds = 3;
    params.refine_settled = 0;
    GlobalThesis method(device, extent);
    method.set_params(params);
    std::vector<Rgb> given = kRoom;
    for (const Rgb& color : random_colors(16, 5)) given.push_back(color);
    given.resize(count);
    method.set_base_colors(given);
    const Plane frame = plane(extent, room(extent, 3));
    const reference::Plane image = testing::to_reference(extent, room(extent, 3));
    const std::vector<reference::Vec3> initial = to_reference(method.colors().layer_colors());
    for (int round = 0; round < 4; ++round) {
      const std::vector<reference::Vec3> before = to_reference(method.colors().layer_colors());
      EXPECT_EQ(method.refining(), round < 3);
      GlobalThesis::Output output;
      uint64_t number = 0;
      run([&](gpu::Commands& commands) { number = method.record(commands, frame, output); });
      const reference::GlobalField x = to_field(extent, count, download(method.solution()));
      method.collect(number);
      EXPECT_EQ(method.stats(number).refining, round < 3);
      const std::vector<reference::Vec3> after = to_reference(method.colors().layer_colors());
      if (round == 3) {
        EXPECT_EQ(after, before);
        break;
      }
      const reference::GlobalThesisParams p = testing::to_reference(params);
      const reference::GlobalScene scene(image, reference::Plane(48, 36), before, p);
      const std::vector<reference::Vec3> expected = reference::refined(
          before, reference::solve_refinement(reference::refinement_system(scene, x, initial, p)));
      double change = 0;
      for (size_t k = 0; k < count; ++k) {
        for (size_t c = 0; c < 3; ++c) {
          EXPECT_NEAR(after[k][c], expected[k][c], 1e-3) << count << " colors, color " << k;
          change = std::max(change, std::abs(after[k][c] - before[k][c]));
        }
      }
      EXPECT_GT(change, 1e-4);
    }
  }
}

TEST_F(GlobalThesisTest, RefinementHoldsUpNoFrameAndEnds) {
  const Extent extent{64, 48};
  GlobalThesis method(device, extent);
  GlobalThesisParams params;
  params.refine_rounds = 30;
  params.lambda_ir = 100;
  method.set_params(params);
  method.set_base_colors(kRoom);
  // Three frames in flight: a frame's system is taken in two frames later.
  const Plane frame = plane(extent, room(extent, 1));
  std::vector<std::unique_ptr<gpu::Commands>> commands;
  for (size_t i = 0; i < gpu::kFramesInFlight; ++i)
    commands.push_back(std::make_unique<gpu::Commands>(device));
  std::vector<uint64_t> numbers;
  int recorded = 0;
  const auto initial = method.colors().layer_colors();
  for (size_t t = 0; t < 90 && method.refining(); ++t) {
    gpu::Commands& own = *commands[t % commands.size()];
    if (t >= commands.size()) {
      own.wait();
      const uint64_t done = numbers[t - commands.size()];
      recorded += method.stats(done).refining;
      method.collect(done);
    }
    own.begin();
    GlobalThesis::Output output;
    numbers.push_back(method.record(own, frame, output));
    own.submit();
  }
  for (auto& own : commands) own->wait();
  EXPECT_FALSE(method.refining());
  EXPECT_GE(recorded, 2);
  EXPECT_LE(recorded, 30);
  EXPECT_NE(method.colors().layer_colors(), initial);
  method.refine();
  EXPECT_TRUE(method.refining());
}

TEST_F(GlobalThesisTest, WarmStartGoesOnWhereTheLastFrameEnded) {
  const Extent extent{64, 48};
  GlobalThesis method(device, extent);
  GlobalThesisParams params;
  params.samples = 0;
  params.steps = 1;
  params.energy = true;
  params.warm_start = true;
  params.refine_rounds = 0;
  method.set_params(params);
  method.set_base_colors(kRoom);
  const Plane frame = plane(extent, room(extent, 1));
  std::vector<double> energies;
  for (int t = 0; t < 12; ++t) {
    GlobalThesis::Output output;
    uint64_t number = 0;
    run([&](gpu::Commands& commands) { number = method.record(commands, frame, output); });
    EXPECT_EQ(method.stats(number).warm, t > 0);
    energies.push_back(method.stats(number).energy.back().total());
  }
  params.warm_start = false;
  params.steps = 12;
  method.set_params(params);
  GlobalThesis::Output output;
  uint64_t number = 0;
  run([&](gpu::Commands& commands) { number = method.record(commands, frame, output); });
  EXPECT_NEAR(energies.back(), method.stats(number).energy.back().total(), 1e-3 * energies.back());
  EXPECT_LT(energies.back(), energies.front());
}

TEST_F(GlobalThesisTest, LabelsOverruleTheClustersAndTheScoreTellsWhichIsSparsest) {
  // The red light on the light floor near the red wall is redder than the floor; taken for red
  // paint or for the floor's own color, the region's indirect light is scored as the reference
  // does.
  const Extent extent{48, 36};
  const Pixels pixels = room(extent, 1);
  const Plane frame = plane(extent, pixels);
  Pixels region(extent.pixels() * 4, 0.0f);
  std::vector<uint8_t> inside(extent.pixels(), 0);
  for (size_t n = 0; n < extent.pixels(); ++n) {
    inside[n] = n % 48 >= 15 && n % 48 < 24;
    region[4 * n] = inside[n];
  }
  const Plane region_plane = plane(extent, region);
  GlobalThesisParams params;
  params.refine_rounds = 0;
  for (int candidate = 0; candidate < 3; ++candidate) {
    Pixels wanted(extent.pixels() * 4, -1.0f);
    for (size_t n = 0; n < extent.pixels(); ++n)
      if (inside[n]) wanted[4 * n] = static_cast<float>(candidate);
    const Plane labels = plane(extent, wanted);
    GlobalThesis method(device, extent);
    method.set_params(params);
    method.set_base_colors(kRoom);
    GlobalThesis::Output output;
    uint64_t number = 0;
    GlobalThesis::Hints hints;
    hints.labels = &labels;
    hints.region = &region_plane;
    run([&](gpu::Commands& commands) { number = method.record(commands, frame, output, hints); });
    const auto stats = method.stats(number);
    const auto colors = to_reference(method.colors().layer_colors());
    const reference::Plane targets = targets_of(method, extent, params.lambda_clustering);
    for (size_t n = 0; n < extent.pixels(); ++n) {
      if (!inside[n]) continue;
      for (size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(targets.data[n][c], std::log(colors[static_cast<size_t>(candidate)][c]), 1e-5);
    }
    const double expected =
        reference::sparsity_score(to_field(extent, 3, download(method.solution())), inside);
    EXPECT_NEAR(stats.score, expected, 1e-4 * expected);
    EXPECT_EQ(stats.region, 9 * 36);
    printf("  color %d: score %g\n", candidate, static_cast<double>(stats.score));
  }
}

TEST_F(GlobalThesisTest, SameSeedGivesTheSameBits) {
  const Extent extent{67, 49};
  std::vector<Pixels> results;
  for (int repeat = 0; repeat < 2; ++repeat) {
    GlobalThesis method(device, extent);
    GlobalThesis::Output output;
    for (uint32_t t = 0; t < 4; ++t) {
      const Plane frame = plane(extent, room(extent, t, t));
      uint64_t number = 0;
      run([&](gpu::Commands& commands) { number = method.record(commands, frame, output); });
      method.collect(number);
    }
    results.push_back(download(output.intrinsic->buffer));
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST_F(GlobalThesisTest, ResetForgetsThePast) {
  const Extent extent{32, 24};
  const Plane first = plane(extent, room(extent, 1)), second = plane(extent, room(extent, 9, 11));
  GlobalThesis fresh(device, extent), used(device, extent);
  const auto twice = [&](GlobalThesis& method, const Plane& frame) {
    GlobalThesis::Output output;
    for (int t = 0; t < 2; ++t) {
      uint64_t number = 0;
      run([&](gpu::Commands& commands) { number = method.record(commands, frame, output); });
      method.collect(number);
    }
    return download(output.intrinsic->buffer);
  };
  const Pixels a = twice(fresh, second);
  twice(used, first);
  used.reset();
  EXPECT_EQ(a, twice(used, second));
}

TEST_F(GlobalThesisTest, CostFollowsTheLayers) {
  // Memory, in fields of four layers; and a frame of another size is refused.
  EXPECT_LT(GlobalThesis::bytes_per_pixel(0, 5), GlobalThesis::bytes_per_pixel(1, 5));
  EXPECT_EQ(GlobalThesis::bytes_per_pixel(1, 5), GlobalThesis::bytes_per_pixel(4, 5));
  const Extent extent{64, 48};
  uint64_t before = 0;
  for (const size_t count : {0, 4, 16}) {
    const uint64_t others = device->memory_bytes();
    GlobalThesis method(device, extent);
    method.set_base_colors(random_colors(count, 1));
    const Plane frame = plane(extent, room(extent, 1));
    GlobalThesis::Output output;
    run([&](gpu::Commands& commands) { method.record(commands, frame, output); });
    EXPECT_GT(device->memory_bytes() - others, before);
    before = device->memory_bytes() - others;
    gpu::Commands commands(device);
    commands.begin();
    EXPECT_THROW(method.record(commands, plane({63, 48}), output), Error);
  }
}

}  // namespace inverse::testing
