// SPDX-License-Identifier: LGPL-2.1-or-later
// Base colors of the thesis' global decomposition: found, refined, overruled; and its state.
#include "global_thesis_fixture.hpp"
#include "tests/differences.hpp"

namespace inverse::testing {

TEST_F(GlobalThesisTest, FindsTheBaseColorsAndIgnoresGray) {
  const Extent extent{96, 72};
  GlobalThesis method(device, extent);
  const auto with_own_colors = [&](const Pixels& pixels) {
    const Plane frame = plane(extent, pixels);
    run([&](gpu::Commands& commands) { method.record_colors(commands, frame); });
    method.collect_colors();
    return decompose(method, frame);
  };
  const auto colored = with_own_colors(room(extent, 1));
  EXPECT_EQ(colored.layers, 2);
  EXPECT_EQ(colored.colors, 3);
  for (const Rgb& wall : {kRoom[0], kRoom[1]}) {
    double nearest = 1;
    for (const Rgb& color : method.colors().layer_colors())
      nearest = std::min(nearest, max_difference(color, wall));
    EXPECT_LT(nearest, 0.105);  // 0.091 and 0.099 when this was written
  }
  // A gray scene has one base color, white, which needs no layer: neither memory nor time.
  Pixels gray = room(extent, 1, 0, 0);
  for (size_t n = 0; n < extent.pixels(); ++n)
    for (size_t c = 1; c < 3; ++c) gray[4 * n + c] = gray[4 * n];
  method.reset();
  const auto none = with_own_colors(gray);
  EXPECT_EQ(none.layers, 0);
  EXPECT_EQ(none.colors, 1);
  EXPECT_EQ(output_[Role::indirect], nullptr);
  for (const float share : download(output_[Role::bases])) EXPECT_EQ(share, 0.0f);
}

TEST_F(GlobalThesisTest, AColorThatIsGoneRetiresWithinTwoSeconds) {
  const Extent extent{96, 72};
  GlobalThesis method(device, extent);
  method.set_params({.steps = 1, .pcg_iterations = 1, .refine_rounds = 0, .cut_chroma = 0});
  const auto blue = [&] {
    int count = 0;
    for (const Rgb& color : method.colors().layer_colors()) count += color[2] > 1.5f * color[0];
    return count;
  };
  Pixels without = room(extent, 1);
  const Pixels with = without;
  for (size_t n = 0; n < extent.pixels(); ++n)
    if (without[4 * n + 2] > 1.3f * without[4 * n]) std::copy_n(&with[0], 4, &without[4 * n]);
  int gone = 0;
  for (int t = 0; t < 160 && gone == 0; ++t) {
    decompose(method, plane(extent, t < 10 ? with : without));
    if (t == 9) {
      ASSERT_GE(blue(), 1);
    }
    if (t > 9 && blue() == 0) gone = t - 9;
  }
  EXPECT_EQ(gone, 38) << "frames: more than a passer-by hides it, less than two seconds";
}

TEST_F(GlobalThesisTest, TheFirstFrameNeedsNoColors) {
  const Extent extent{64, 48};
  GlobalThesis method(device, extent);
  const Plane frame = plane(extent, room(extent, 1));
  std::vector<int> layers;
  for (int t = 0; t < 3; ++t) layers.push_back(decompose(method, frame).layers);
  EXPECT_EQ(layers[0], 0);
  EXPECT_EQ(layers[1], 2);
  EXPECT_EQ(layers[2], layers[1]);
}

TEST_F(GlobalThesisTest, RefinementAgreesWithReference) {
  const Extent extent{48, 36};
  for (const size_t count : {1, 3, 6, 16}) {
    GlobalThesisParams params;
    params.steps = 8;  // with fewer colors stay as they are in two of the rounds
    params.samples = 0;
    params.refine_rounds = 3;
    params.refine_tolerance = 0;
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
      EXPECT_EQ(decompose(method, frame).refining, round < 3);
      const reference::GlobalField x = to_field(extent, count, download(method.solution()));
      const std::vector<reference::Vec3> after = to_reference(method.colors().layer_colors());
      if (round == 3) {
        EXPECT_EQ(after, before);
        break;
      }
      const reference::GlobalThesisParams p = testing::to_reference(params);
      const reference::GlobalThesisScene scene(image, reference::Plane(48, 36), before, p);
      const std::vector<reference::Vec3> expected = reference::refined(
          before, reference::solve_refinement(reference::refinement_system(scene, x, initial, p)));
      double change = 0;
      for (size_t k = 0; k < count; ++k) {
        EXPECT_LE(max_difference(after[k], expected[k]), 1e-3) << count << " colors, color " << k;
        update_max(change, max_difference(after[k], before[k]));
      }
      EXPECT_GT(change, 1e-4);
    }
  }
}

TEST_F(GlobalThesisTest, RefinementBlocksNoFrameAndEnds) {
  const Extent extent{64, 48};
  GlobalThesis method(device, extent);
  method.set_params({.lambda_cr = 1e6f, .refine_rounds = 30});
  method.set_base_colors(kRoom);
  const Plane frame = plane(extent, room(extent, 1));
  int recorded = 0;
  const auto initial = method.colors().layer_colors();
  play_frames(
      90, [&](gpu::Commands& commands, size_t) { method.record(commands, frame, output_); },
      [&](size_t t) {
        recorded += method.stats(t).refining;
        method.collect(t);
        return method.refining();
      });
  EXPECT_FALSE(method.refining());
  EXPECT_EQ(recorded, 2);
  EXPECT_NE(method.colors().layer_colors(), initial);
  method.refine();
  EXPECT_TRUE(method.refining());
}

TEST_F(GlobalThesisTest, ThePalettesOwnColorsAreRefinedWhileFramesAreInFlight) {
  // The palette moves with every noisy frame; what is being refined stays where it is.
  const Extent extent{64, 48};
  GlobalThesis method(device, extent);
  method.set_params({.warm_start = true, .refine_rounds = 3, .refine_tolerance = 0});
  std::vector<Plane> frames;
  int warm = 0;
  play_frames(
      24,
      [&](gpu::Commands& commands, size_t t) {
        frames.push_back(plane(extent, room(extent, static_cast<unsigned>(t))));
        method.record(commands, frames.back(), output_);
      },
      [&](size_t t) {
        warm += method.stats(t).warm;
        method.collect(t);
        return true;
      });
  EXPECT_FALSE(method.refining());
  EXPECT_EQ(method.colors().layers(), 2);
  EXPECT_NE(method.colors().layer_colors(), method.colors().layer_colors(true));
  EXPECT_EQ(warm, 22);
}

TEST_F(GlobalThesisTest, WarmStartGoesOnWhereTheLastFrameEnded) {
  const Extent extent{64, 48};
  GlobalThesis method(device, extent);
  GlobalThesisParams params{
      .steps = 1, .warm_start = true, .samples = 0, .refine_rounds = 0, .energy = true};
  method.set_params(params);
  method.set_base_colors(kRoom);
  const Plane frame = plane(extent, room(extent, 1));
  std::vector<double> energies;
  for (int t = 0; t < 12; ++t) {
    const auto stats = decompose(method, frame);
    EXPECT_EQ(stats.warm, t > 0);
    energies.push_back(stats.energy.back().total());
  }
  params.warm_start = false;
  params.steps = 12;
  method.set_params(params);
  EXPECT_NEAR(energies.back(), decompose(method, frame).energy.back().total(),
              1e-3 * energies.back());
  EXPECT_LT(energies.back(), energies.front());
}

TEST_F(GlobalThesisTest, SameSeedGivesTheSameBits) {
  const Extent extent{67, 49};
  std::vector<Pixels> results;
  for (int repeat = 0; repeat < 2; ++repeat) {
    GlobalThesis method(device, extent);
    for (uint32_t t = 0; t < 4; ++t) decompose(method, plane(extent, room(extent, t, t)));
    results.push_back(download(output_[Role::intrinsic]));
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST_F(GlobalThesisTest, ResetForgetsThePast) {
  const Extent extent{32, 24};
  const Plane first = plane(extent, room(extent, 1)), second = plane(extent, room(extent, 9, 11));
  GlobalThesis fresh(device, extent), used(device, extent);
  const auto twice = [&](GlobalThesis& method, const Plane& frame) {
    for (int t = 0; t < 2; ++t) decompose(method, frame);
    return download(output_[Role::intrinsic]);
  };
  const Pixels a = twice(fresh, second);
  twice(used, first);
  used.reset();
  EXPECT_EQ(a, twice(used, second));
}

TEST_F(GlobalThesisTest, FindingColorsIsNoFrame) {
  // Three frames are in flight at the cut.
  const Extent extent{32, 24};
  GlobalThesis method(device, extent);
  const Plane frame = plane(extent, room(extent, 1));
  std::vector<uint64_t> numbers;
  for (size_t t = 0; t < gpu::kFramesInFlight; ++t)
    run([&](gpu::Commands& commands) {
      numbers.push_back(method.record(commands, frame, output_));
    });
  method.reset();
  run([&](gpu::Commands& commands) { method.record_colors(commands, frame); });
  method.collect_colors();
  EXPECT_EQ(method.colors().layers(), 2);
  for (const uint64_t number : numbers) {
    EXPECT_NO_THROW(method.stats(number));
    method.collect(number);
  }
}

TEST_F(GlobalThesisTest, ACutDiscardsTheSceneAndBlocksNoFrame) {
  const Extent extent{64, 48};
  constexpr size_t kCut = 12;
  for (const float fraction : {0.2f, 0.0f}) {
    GlobalThesis method(device, extent);
    method.set_params(
        {.steps = 2, .keyframe_spacing = 1, .refine_rounds = 2, .cut_chroma = fraction});
    std::vector<Plane> frames;
    std::vector<GlobalThesis::Stats> seen;
    play_frames(
        30,
        [&](gpu::Commands& commands, size_t t) {
          if (t == kCut) {
            EXPECT_FALSE(method.refining());
          }
          Pixels pixels = room(extent, static_cast<unsigned>(t), static_cast<uint32_t>(t) / 2);
          for (size_t n = 0; t >= kCut && n < extent.pixels(); ++n)
            std::swap(pixels[4 * n], pixels[4 * n + 1]);
          frames.push_back(plane(extent, pixels));
          ASSERT_EQ(method.record(commands, frames.back(), output_), t);
        },
        [&](size_t t) {
          method.collect(t);
          seen.push_back(method.stats(t));
          return true;
        });
    double nearest = 1;  // to the new scene's green wall
    for (const Rgb& color : method.colors().layer_colors())
      nearest = std::min<double>(
          nearest, std::max({std::abs(color[0] - kRoom[0][1]), std::abs(color[1] - kRoom[0][0]),
                             std::abs(color[2] - kRoom[0][2])}));
    float steady = 0;
    for (size_t t = 0; t < seen.size(); ++t) {
      EXPECT_EQ(seen[t].cut, fraction > 0 && t == kCut) << t;
      if (t != kCut) update_max(steady, seen[t].change);
    }
    if (fraction == 0) {
      EXPECT_EQ(seen[kCut + 3].keyframes, 5);
      EXPECT_EQ(method.scene_since(), 0u);
      continue;
    }
    printf("  change %.3f at the cut, at most %.3f elsewhere\n",
           static_cast<double>(seen[kCut].change), static_cast<double>(steady));
    EXPECT_GT(seen[kCut].change, 0.5f);
    EXPECT_LT(steady, 0.2f);  // noise, and walls that move
    EXPECT_EQ(seen[kCut + 2].keyframes, 5);
    EXPECT_EQ(seen[kCut + 3].keyframes, 0);  // the first after it was found
    EXPECT_EQ(method.scene_since(), kCut + 6);
    int refined = 0;
    for (size_t t = kCut; t < seen.size(); ++t) {
      refined += seen[t].refining;
      EXPECT_GT(seen[t].layers, 0) << t;
      if (t < kCut + 6) {
        EXPECT_FALSE(seen[t].refining) << t;
      }
    }
    EXPECT_EQ(refined, 2);
    EXPECT_LT(nearest, 0.156);  // 0.148
  }
}

TEST_F(GlobalThesisTest, ACutPreservesTheGivenColors) {
  const Extent extent{32, 24};
  GlobalThesis method(device, extent);
  method.set_base_colors(kRoom);
  const auto given = method.colors().layer_colors();
  GlobalThesis::Stats stats;
  for (int t = 0; t < 2; ++t) {
    Pixels pixels = room(extent, 1);
    for (size_t n = 0; t == 1 && n < extent.pixels(); ++n)
      std::swap(pixels[4 * n], pixels[4 * n + 1]);
    method.set_params({.refine_rounds = 0});
    stats = decompose(method, plane(extent, pixels));
  }
  EXPECT_TRUE(stats.cut);
  EXPECT_EQ(method.colors().layer_colors(), given);
  EXPECT_EQ(method.scene_since(), 0u);
}

TEST(BaseColors, RefinementRejectsNonFiniteValues) {
  BaseColors colors;
  colors.set(kRoom);
  const auto before = colors.layer_colors();
  EXPECT_EQ(colors.refine(std::vector<Rgb>{{kNan, 0.1f, -kInf}, {0, 0, 0}, {0, kInf, 0}}), 1.0f);
  const auto after = colors.layer_colors();
  EXPECT_EQ(after[0][0], before[0][0]);
  EXPECT_FLOAT_EQ(after[0][1], before[0][1] + 0.1f);
  EXPECT_EQ(after[0][2], before[0][2]);
  EXPECT_EQ(after[1], before[1]);
  EXPECT_EQ(after[2], before[2]);
}

TEST_F(GlobalThesisTest, CostFollowsTheLayers) {
  // Memory, in fields of four layers; and a frame of another size is refused.
  const Extent extent{64, 48};
  uint64_t before = 0;
  for (const size_t count : {0, 4, 16}) {
    output_ = {};
    const uint64_t others = device->memory_bytes();
    GlobalThesis method(device, extent);
    method.set_base_colors(random_colors(count, 1));
    decompose(method, plane(extent, room(extent, 1)));
    EXPECT_GT(device->memory_bytes() - others, before);
    before = device->memory_bytes() - others;
    gpu::Commands commands(device);
    commands.begin();
    EXPECT_THROW(method.record(commands, plane({63, 48}), output_), Error);
  }
}

}  // namespace inverse::testing
