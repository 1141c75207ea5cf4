// SPDX-License-Identifier: LGPL-2.1-or-later
// The thesis' global decomposition at its limits: light that spans decades, and more layers than
// the device can bind.
#include <array>
#include <bit>
#include <cmath>

#include "global_thesis_fixture.hpp"
#include "kernels/thesis_chapter5_solve_scale_step.spv.hpp"
#include "tests/expect_error.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {

/// The room in patches of light from 10^−decades/2 to 10^decades/2.
static Pixels spanning(Extent extent, float decades) {
  Pixels pixels = room(extent, 3);
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(-0.5f, 0.5f);
  float lights[12];
  for (float& light : lights) light = std::pow(10.0f, decades * unit(random));
  lights[2] = std::pow(10.0f, 0.5f * decades);
  lights[3] = std::pow(10.0f, -0.5f * decades);
  for (size_t n = 0; n < extent.pixels(); ++n) {
    const size_t patch = n % extent.width / 7 + 3 * (n / extent.width / 5);
    for (size_t c = 0; c < 3; ++c) pixels[4 * n + c] *= lights[patch % 12];
  }
  return pixels;
}

TEST_F(GlobalThesisTest, StepsAreShortenedAsInTheReference) {
  const Extent extent{37, 21};
  for (const float decades : {1.0f, 8.0f}) {
    const Pixels pixels = spanning(extent, decades);
    GlobalThesisParams params{.steps = 16, .samples = 0, .refine_rounds = 0, .trace = true};
    double final_energy[2] = {}, reference_energy[2] = {};
    int shortened[2] = {}, reference_shortened[2] = {};
    for (const bool search : {false, true}) {
      params.line_search = search;
      GlobalThesis method(device, extent);
      method.set_params(params);
      method.set_base_colors(kRoom);
      const auto stats = decompose(method, plane(extent, pixels));
      final_energy[search] = stats.energy.back().total();
      shortened[search] = stats.shortened;
      for (size_t k = 1; search && k < stats.energy.size(); ++k) {
        const double rest =
            stats.energy[k].total() - static_cast<double>(stats.energy[k].non_negativity);
        EXPECT_LE(rest, stats.energy[k - 1].total() * (1 + 2e-5)) << decades << ", step " << k;
      }
      reference::GlobalThesis expected(testing::to_reference(params));
      const auto x =
          expected.decompose(testing::to_reference(extent, pixels), targets_of(method, extent),
                             to_reference(method.colors().layer_colors()));
      reference_energy[search] = expected.energy(x).total();
      reference_shortened[search] = expected.shortened();
    }
    printf(
        "  %g decades: energy %.5g, with search %.5g (%d steps shortened); reference %.5g, %.5g "
        "(%d)\n",
        static_cast<double>(decades), final_energy[0], final_energy[1], shortened[1],
        reference_energy[0], reference_energy[1], reference_shortened[1]);
    EXPECT_EQ(shortened[0], 0);
    if (decades < 2) {
      // Nothing to be shortened: the same result.
      EXPECT_NEAR(final_energy[1], reference_energy[1], 1e-4 * reference_energy[1]);
      EXPECT_EQ(shortened[1], 0);
      EXPECT_EQ(reference_shortened[1], 0);
      EXPECT_EQ(final_energy[0], final_energy[1]);
    } else {
      // Rounding decides which steps are shortened, 2 to 6 on the variants, and so which minimum
      // is found: one as deep as the reference's.
      EXPECT_LE(final_energy[1], 1.03 * reference_energy[1]);
      EXPECT_GE(shortened[1], 2);
      EXPECT_EQ(reference_shortened[1], 6);
      EXPECT_LT(final_energy[1], 0.97 * final_energy[0]);
    }
  }
}

TEST_F(GlobalThesisTest, ARejectedStepChangesNothing) {
  const Extent extent{70, 3};
  const Pixels from = random_pixels(extent, 1);
  Pixels to = random_pixels(extent, 2);
  for (size_t n = 0; n < to.size(); n += 3) to[n] = n % 2 ? kNan : kInf;
  using Shader = shaders::thesis_chapter5_solve_scale_step;
  auto push = std::bit_cast<Shader::Push>(std::array<std::byte, sizeof(Shader::Push)>{});
  push.size = extent;
  for (const float factor : {0.0f, 0.25f, 1.0f}) {
    const Plane state = plane(extent, from), next = plane(extent, to);
    const float search[4] = {0, factor, 0, 0};
    const gpu::BufferPtr said = upload(gpu::Element::scalar, search, 4);
    run([&](gpu::Commands& commands) {
      commands.dispatch(gpu::Program<Shader>(device),
                        {.state = state.buffer, .search = said, .next = next.buffer}, push,
                        {extent.width, extent.height});
    });
    const Pixels got = download(next);
    for (size_t n = 0; n < got.size(); ++n) {
      if (factor == 0) {
        ASSERT_EQ(got[n], from[n]) << n;
      } else if (!std::isfinite(to[n])) {
        ASSERT_FALSE(std::isfinite(got[n])) << n;
      } else if (factor == 1) {
        ASSERT_EQ(got[n], to[n]) << n;
      } else {
        ASSERT_NEAR(got[n], from[n] + 0.25f * (to[n] - from[n]), 1e-6f) << n;
      }
    }
  }
}

TEST_F(GlobalThesisTest, SamplesRaiseTheRestOfTheEnergyByLittleInAll) {
  // A frame that starts where it was solved without samples, and is then drawn strongly to all of
  // them, whatever their color.
  const Extent extent{37, 21};
  const Plane frame = plane(extent, room(extent, 3));
  GlobalThesis method(device, extent);
  GlobalThesisParams params{.steps = 16,
                            .warm_start = true,
                            .samples = 0,
                            .keyframes = 0,
                            .refine_rounds = 0,
                            .trace = true};
  method.set_params(params);
  method.set_base_colors(kRoom);
  decompose(method, frame);
  params.samples = 9;
  params.tau_cc = 3;
  params.lambda_r_consistency = 10;
  method.set_params(params);
  const auto trace = decompose(method, frame).energy;
  const auto without_samples = [](const GlobalThesis::Energy& e) {
    return e.total() - static_cast<double>(e.r_consistency);
  };
  const double start = without_samples(trace.front());
  double highest = 0;
  for (size_t k = 1; k < trace.size(); ++k) {
    const double rest = without_samples(trace[k]) - static_cast<double>(trace[k].non_negativity);
    update_max(highest, rest / start);
    EXPECT_LE(rest, std::max(without_samples(trace[k - 1]), 1.05 * start) * (1 + 2e-5))
        << "step " << k;
  }
  EXPECT_GT(highest, 1.01) << "the samples have no effect";
}

TEST_F(GlobalThesisTest, LayersThatTheDeviceCannotBindAreOmitted) {
  EXPECT_EQ(GlobalThesis::max_layers(*device, {64, 48}), static_cast<int>(kMaxBases));
  // The first of these sizes that does not take all.
  Extent extent{640, 480};
  while (GlobalThesis::max_layers(*device, extent) == static_cast<int>(kMaxBases) &&
         extent.pixels() < 8'000'000)
    extent.width += 640;
  const int largest = GlobalThesis::max_layers(*device, extent);
  if (largest == static_cast<int>(kMaxBases)) GTEST_SKIP() << "the device binds all of them";
  EXPECT_EQ(largest, 12) << extent.width;
  GlobalThesis method(device, extent);
  method.set_params({.clusters = 16});
  EXPECT_EQ(method.params().clusters, largest);
  EXPECT_NO_THROW(method.set_base_colors(random_colors(static_cast<size_t>(largest), 1)));
  // Not only when a frame needs it.
  expect_error(ErrorKind::limit, std::to_string(extent.width),
               [&] { method.set_base_colors(random_colors(static_cast<size_t>(largest) + 1, 1)); });
}

}  // namespace inverse::testing
