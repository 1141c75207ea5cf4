// Base colors of the thesis' global decomposition: found, refined, overruled; and its state.
#include "global_thesis_fixture.hpp"

namespace inverse::testing {

TEST_F(GlobalThesisTest, FindsTheBaseColorsAndLeavesOutWhatIsGray) {
  const Extent extent{96, 72};
  GlobalThesis method(device, extent);
  const auto decompose = [&](const Pixels& pixels, Layers& output) {
    const Plane frame = plane(extent, pixels);
    uint64_t number = 0;
    run([&](gpu::Commands& commands) { number = method.record_colors(commands, frame); });
    method.collect(number);
    run([&](gpu::Commands& commands) { number = method.record(commands, frame, output); });
    method.collect(number);
    return method.stats(number);
  };
  Layers output;
  const auto colored = decompose(room(extent, 1), output);
  EXPECT_GE(colored.layers, 2);
  EXPECT_GE(colored.colors, 3);
  for (const Rgb& wall : {kRoom[0], kRoom[1]}) {
    double nearest = 1;
    for (const Rgb& color : method.colors().layer_colors()) {
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
  EXPECT_EQ(output[Role::indirect], nullptr);
  for (const float share : download(output[Role::bases]->buffer)) EXPECT_EQ(share, 0.0f);
}

TEST_F(GlobalThesisTest, TheFirstFrameNeedsNoColors) {
  const Extent extent{64, 48};
  GlobalThesis method(device, extent);
  const Plane frame = plane(extent, room(extent, 1));
  std::vector<int> layers;
  for (int t = 0; t < 3; ++t) {
    Layers output;
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
      Layers output;
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
      const reference::GlobalThesisScene scene(image, reference::Plane(48, 36), before, p);
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
  params.lambda_cr = 1e6f;
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
    Layers output;
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

TEST_F(GlobalThesisTest, ThePalettesOwnColorsAreRefinedWhileFramesAreInFlight) {
  // The palette moves with every noisy frame; what is being refined stays where it is.
  const Extent extent{64, 48};
  GlobalThesis method(device, extent);
  GlobalThesisParams params;
  params.refine_rounds = 3;
  params.refine_settled = 0;
  params.warm_start = true;
  method.set_params(params);
  std::vector<std::unique_ptr<gpu::Commands>> commands;
  for (size_t i = 0; i < gpu::kFramesInFlight; ++i)
    commands.push_back(std::make_unique<gpu::Commands>(device));
  std::vector<uint64_t> numbers;
  std::vector<Plane> frames;
  int warm = 0;
  for (size_t t = 0; t < 24; ++t) {
    gpu::Commands& own = *commands[t % commands.size()];
    if (t >= commands.size()) {
      own.wait();
      const uint64_t done = numbers[t - commands.size()];
      warm += method.stats(done).warm;
      method.collect(done);
    }
    own.begin();
    Layers output;
    frames.push_back(plane(extent, room(extent, static_cast<unsigned>(t))));
    numbers.push_back(method.record(own, frames.back(), output));
    own.submit();
  }
  for (auto& own : commands) own->wait();
  EXPECT_FALSE(method.refining());
  EXPECT_GE(method.colors().layers(), 2);
  EXPECT_NE(method.colors().layer_colors(), method.colors().layer_colors(true));
  EXPECT_GE(warm, 8);
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
    Layers output;
    uint64_t number = 0;
    run([&](gpu::Commands& commands) { number = method.record(commands, frame, output); });
    EXPECT_EQ(method.stats(number).warm, t > 0);
    energies.push_back(method.stats(number).energy.back().total());
  }
  params.warm_start = false;
  params.steps = 12;
  method.set_params(params);
  Layers output;
  uint64_t number = 0;
  run([&](gpu::Commands& commands) { number = method.record(commands, frame, output); });
  EXPECT_NEAR(energies.back(), method.stats(number).energy.back().total(), 1e-3 * energies.back());
  EXPECT_LT(energies.back(), energies.front());
}

TEST_F(GlobalThesisTest, SameSeedGivesTheSameBits) {
  const Extent extent{67, 49};
  std::vector<Pixels> results;
  for (int repeat = 0; repeat < 2; ++repeat) {
    GlobalThesis method(device, extent);
    Layers output;
    for (uint32_t t = 0; t < 4; ++t) {
      const Plane frame = plane(extent, room(extent, t, t));
      uint64_t number = 0;
      run([&](gpu::Commands& commands) { number = method.record(commands, frame, output); });
      method.collect(number);
    }
    results.push_back(download(output[Role::intrinsic]->buffer));
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST_F(GlobalThesisTest, ResetForgetsThePast) {
  const Extent extent{32, 24};
  const Plane first = plane(extent, room(extent, 1)), second = plane(extent, room(extent, 9, 11));
  GlobalThesis fresh(device, extent), used(device, extent);
  const auto twice = [&](GlobalThesis& method, const Plane& frame) {
    Layers output;
    for (int t = 0; t < 2; ++t) {
      uint64_t number = 0;
      run([&](gpu::Commands& commands) { number = method.record(commands, frame, output); });
      method.collect(number);
    }
    return download(output[Role::intrinsic]->buffer);
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
    Layers output;
    run([&](gpu::Commands& commands) { method.record(commands, frame, output); });
    EXPECT_GT(device->memory_bytes() - others, before);
    before = device->memory_bytes() - others;
    gpu::Commands commands(device);
    commands.begin();
    EXPECT_THROW(method.record(commands, plane({63, 48}), output), Error);
  }
}

}  // namespace inverse::testing
