// SPDX-License-Identifier: LGPL-2.1-or-later
// No kernel of globalintrinsic is built in mid-stream.
#include "kernels/global/global_levels.hpp"
#include "tests/kernels/intrinsic/intrinsic_fixture.hpp"

namespace inverse::testing {

class GlobalWarmUp : public OnANewDevice<IntrinsicTest> {
 protected:
  /// A video in which everything comes, three frames in flight: light that is reused and
  /// recomputed, with layers out and without, cuts, gray, the lamps' color, few base colors, every
  /// quality level. Counts what came.
  struct Seen {
    unsigned held = 0, plain = 0, shares = 0;
  };
  Seen play(GlobalIntrinsic& method, Extent extent) {
    std::vector<std::unique_ptr<gpu::Commands>> commands;
    for (size_t i = 0; i < gpu::kFramesInFlight; ++i)
      commands.push_back(std::make_unique<gpu::Commands>(device));
    Seen seen;
    size_t t = 0;
    const auto show = [&](const PlanePtr& picture, const GlobalIntrinsic::Params& params, bool same,
                          bool shares) {
      gpu::Commands& own = *commands[t++ % commands.size()];
      own.wait();
      own.begin();
      const Layers layers =
          method.record(own, picture, params, {.shares = shares, .repeated = same});
      own.submit();
      const auto& stats = last_stats(method);
      seen.held += stats.light.reused();
      seen.plain += stats.light.gray;
      seen.shares += bool(layers[Role::bases]);
    };
    GlobalIntrinsic::Params params;
    const PlanePtr still = input(extent, scene(extent, 31));
    for (int k = 0; k < 40; ++k) show(still, params, k > 0, k % 3 > 0);
    for (unsigned k = 0; k < 6; ++k)
      show(input(extent, scene(extent, 40 + k)), params, false, k % 2);  // cuts
    const PlanePtr gray = input(extent, Pixels(4 * extent.pixels(), 0.25F));
    for (int k = 0; k < 20; ++k) show(gray, params, k % 5 > 0, k % 2);
    for (int k = 0; k < 8; ++k) show(still, params, false, true);
    for (const int colors : {3, 6, 11, 16}) {
      params.base_colors = colors;
      for (int k = 0; k < 3; ++k) show(still, params, k > 0, true);
    }
    params.white_balance = 0.5F;
    for (int k = 0; k < 4; ++k) show(still, params, k > 0, true);
    params = {};
    for (const auto& level : global_levels().levels) {
      level.set(params);
      for (int k = 0; k < 3; ++k) show(still, params, k > 0, false);
    }
    params = {};
    params.adaptive = false;
    for (int k = 0; k < 3; ++k) show(still, params, false, true);
    for (auto& own : commands) own->wait();
    return seen;
  }
};

TEST_F(GlobalWarmUp, BuildsEveryKernelBeforeTheStream) {
  for (const Extent extent : {Extent{349, 287}, Extent{150, 110}}) {
    GlobalIntrinsic method(device, extent);
    gpu::build_kernels(device);
    const uint64_t warm = device->kernels_used();
    const Seen seen = play(method, extent);
    EXPECT_EQ(device->kernels_used(), warm) << name_of(extent);
    EXPECT_GT(seen.held, 20U);
    EXPECT_GT(seen.plain, 5U);
    EXPECT_GT(seen.shares, 40U);
  }
}

TEST_F(GlobalWarmUp, WithoutItTheStreamBuildsKernels) {
  const Extent extent{349, 287};
  GlobalIntrinsic method(device, extent);
  const PlanePtr frame = input(extent, scene(extent, 31));
  run([&](gpu::Commands& commands) { method.record(commands, frame, {}, {}); });
  const uint64_t first = device->kernels_used();
  play(method, extent);
  EXPECT_GT(device->kernels_used(), first + 20);
}

}  // namespace inverse::testing
