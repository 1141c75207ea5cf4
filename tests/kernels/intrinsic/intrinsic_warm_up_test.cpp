// SPDX-License-Identifier: LGPL-2.1-or-later
// No kernel of intrinsicdecomp is built in mid-stream.
#include "intrinsic_fixture.hpp"
#include "kernels/intrinsic/intrinsic_levels.hpp"
#include "prior_graph.hpp"

namespace inverse::testing {

class IntrinsicWarmUp : public OnANewDevice<IntrinsicTest> {
 protected:
  static constexpr Extent kExtent{349, 287};
  /// A video in which everything comes, three frames in flight: repeats, cuts, gray, a fast camera,
  /// every quality level, resolutions that are compared and crossed, other parameters. Returns how
  /// many frames compared, how many crossed.
  struct Seen {
    unsigned compared = 0, crossed = 0;
  };
  Seen play(ScaledIntrinsic& method, const PriorModelPtr& network = nullptr) {
    std::vector<std::unique_ptr<gpu::Commands>> commands;
    for (size_t i = 0; i < gpu::kFramesInFlight; ++i)
      commands.push_back(std::make_unique<gpu::Commands>(device));
    std::vector<PlanePtr> alive;
    Seen seen;
    size_t t = 0;
    const auto show = [&](const PlanePtr& picture, const ScaledIntrinsic::Params& params,
                          bool same) {
      gpu::Commands& own = *commands[t++ % commands.size()];
      own.wait();
      own.begin();
      alive.push_back(picture);
      method.record(own, picture, params, {.repeated = same});
      own.submit();
      const auto& stats = method.stats(method.recorded() - 1);
      seen.compared += stats.compared;
      seen.crossed += stats.crossed;
    };
    ScaledIntrinsic::Params usual;
    usual.prior.network = network;
    ScaledIntrinsic::Params params = usual;
    const PlanePtr still = input(kExtent, scene(kExtent, 31));
    for (int k = 0; k < 28; ++k) show(still, params, k > 0);
    params.scale.white_level = 0.5F;
    for (int k = 0; k < 6; ++k) show(still, params, true);
    for (unsigned k = 0; k < 6; ++k)
      show(input(kExtent, scene(kExtent, 40 + k)), params, false);  // cuts
    const PlanePtr gray = input(kExtent, Pixels(4 * kExtent.pixels(), 0.25F));
    for (int k = 0; k < 20; ++k) show(gray, params, k % 5 > 0);
    for (const auto& level : intrinsic_levels().levels) {
      level.set(params);
      for (int k = 0; k < 5; ++k) show(still, params, k > 0);
    }
    params = usual;
    params.tolerances.half = 1;  // half resolution is good enough
    for (int k = 0; k < 40; ++k) show(still, params, k > 0);
    params.tolerances.half = 0;
    for (int k = 0; k < 8; ++k) show(still, params, k > 0);
    params.prior.chroma_weight = 0;
    for (int k = 0; k < 8; ++k) show(still, params, k > 0);
    params.anchor.anchor_weight = 0;
    for (int k = 0; k < 3; ++k) show(still, params, false);
    params = usual;
    params.adaptive = false;
    for (int k = 0; k < 3; ++k) show(still, params, false);
    for (auto& own : commands) own->wait();
    return seen;
  }
};

TEST_F(IntrinsicWarmUp, BuildsEveryKernelBeforeTheStream) {
  ScaledIntrinsic method(device, kExtent);
  gpu::build_kernels(device);
  const uint64_t warm = device->kernels_used();
  const Seen seen = play(method);
  EXPECT_EQ(device->kernels_used(), warm);
  EXPECT_GT(seen.compared, 1U);
  EXPECT_GT(seen.crossed, 4U);
}

TEST_F(IntrinsicWarmUp, BuildsThoseOfANetworkToo) {
  const PriorModelPtr network = prior_model(3);
  ScaledIntrinsic method(device, kExtent);
  method.prepare(0, network);
  gpu::build_kernels(device);
  const uint64_t warm = device->kernels_used();
  const Seen seen = play(method, network);
  EXPECT_EQ(device->kernels_used(), warm);
  EXPECT_GT(seen.crossed, 4U);
}

TEST_F(IntrinsicWarmUp, WithoutItTheStreamBuildsKernels) {
  ScaledIntrinsic method(device, kExtent);
  const PlanePtr frame = input(kExtent, scene(kExtent, 31));
  run([&](gpu::Commands& commands) { method.record(commands, frame, {}, {}); });
  const uint64_t first = device->kernels_used();
  play(method);
  EXPECT_GT(device->kernels_used(), first + 20);
}

}  // namespace inverse::testing
