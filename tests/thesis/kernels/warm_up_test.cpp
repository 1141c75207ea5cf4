// SPDX-License-Identifier: LGPL-2.1-or-later
// Nothing is built in mid-stream: what other scenes, refinement and correction will need is there
// before the first frame.
#include "global_thesis_fixture.hpp"
#include "kernels/thesis/chapter5/correction/misclustering_correction.hpp"
#include "kernels/thesis/chapter5/correction/region_proposals.hpp"

namespace inverse::testing {
namespace {

class WarmUp : public OnANewDevice<GlobalThesisTest> {
 protected:
  static constexpr Extent kExtent{96, 72};

  /// A video in which everything comes: all numbers of layers, refinement, a correction, other
  /// numbers of clusters, a cut. Three frames in flight, and nothing waits for the one just
  /// recorded. Returns the regions corrected.
  int play(GlobalThesis& method, GlobalThesisParams params) {
    MarkedRegions regions(device, kExtent);
    MisclusteringCorrection correction(device, kExtent);
    RegionProposals proposals(device, kExtent);
    struct Numbers {
      uint64_t method, regions, correction, proposals;
    };
    std::vector<Numbers> numbers;
    std::vector<Plane> frames;
    int corrected = 0;
    const auto record = [&](gpu::Commands& commands, size_t frame) {
      const auto t = static_cast<uint32_t>(frame);
      if (t == 4) regions.click(5, 5);
      if (t == 20) method.refine();
      if (t > 20 && t % 10 == 5) {
        params.clusters = static_cast<int>(1 + 5 * (t / 10) % 16);
        method.set_params(params);
      }
      if (t >= 30 && t < 35) method.set_base_colors(random_colors(4 * (t - 30), t));
      if (t == 35) method.reset();
      Pixels pixels = room(kExtent, t, t > 20 ? t : 0);
      if (t > 45)
        for (size_t i = 0; i < pixels.size(); i += 4) std::swap(pixels[i], pixels[i + 1]);
      frames.push_back(plane(kExtent, pixels));
      const uint64_t number = method.record(commands, frames.back(), output_, {&regions});
      numbers.push_back(
          {number, regions.last(), correction.record(commands, method, regions),
           proposals.record(commands, method, regions, RegionProposals::Mode::correct)});
    };
    play_frames(60, record, [&](size_t t) {
      method.collect(numbers[t].method);
      regions.collect(numbers[t].regions);
      corrected += correction.collect(numbers[t].correction, regions).has_value();
      proposals.collect(numbers[t].proposals, regions);
      return true;
    });
    return corrected;
  }
};

TEST_F(WarmUp, BuildsEveryKernelBeforeTheStream) {
  GlobalThesis method(device, kExtent);
  const GlobalThesisParams params{.steps = 2, .pcg_iterations = 2, .keyframe_spacing = 2};
  method.set_params(params);
  method.make_kernels();
  MarkedRegions(device, kExtent);
  MisclusteringCorrection(device, kExtent).make_kernels(method);
  RegionProposals(device, kExtent);
  gpu::build_kernels(device);
  const uint64_t warm = device->kernels_used();
  EXPECT_GE(play(method, params), 1);
  EXPECT_EQ(device->kernels_used(), warm);
}

TEST_F(WarmUp, WithoutItTheStreamBuildsKernels) {
  GlobalThesis method(device, kExtent);
  const GlobalThesisParams params{.steps = 2, .pcg_iterations = 2};
  method.set_params(params);
  decompose(method, plane(kExtent, room(kExtent, 1)));
  const uint64_t first = device->kernels_used();
  play(method, params);
  EXPECT_GT(device->kernels_used(), first + 20);
}

}  // namespace
}  // namespace inverse::testing
