// SPDX-License-Identifier: LGPL-2.1-or-later
// After a stream of extreme frames a decomposer decomposes an image as a new one does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pictures.hpp"
#include "tests/differences.hpp"

namespace inverse::extremes {
namespace {

constexpr Extent kExtent{61, 44};
constexpr uint32_t kFrames = 60;

/// A frame of another mixture of faults each time.
Pixels extreme(uint32_t frame, Solver solver = Solver::multigrid) {
  Case one = random_case(solver, frame + 1, 64);
  one.width = kExtent.width;
  one.height = kExtent.height;
  return frame_of(one, frame);
}

const Case kPicture{Solver::multigrid, kExtent.width, kExtent.height, 1, 5, 0, 0};

TEST(Recovery, ACutDiscardsAllHistory) {
  const Lab lab;
  Method used(lab, Solver::multigrid, kExtent), fresh(lab, Solver::multigrid, kExtent);
  for (uint32_t frame = 0; frame < kFrames; ++frame) used.decompose(extreme(frame));
  used.decompose(Pixels(4 * kExtent.pixels(), 0.0F));  // black: whatever follows is a cut
  const Pixels picture = frame_of(kPicture, 0);
  IntrinsicDecomposition::Params params;
  params.warm_cycles = params.cycles;  // a cut is found on the device, after cycles were recorded
  used.set(params);
  const Pixels got = used.decompose_unscaled(picture).intrinsic;
  const Pixels expected = fresh.decompose_unscaled(picture).intrinsic;
  EXPECT_LT(max_difference(log_shading_of(got), log_shading_of(expected)), 1e-5);
}

TEST(Recovery, AResetDiscardsAllHistory) {
  const Lab lab;
  for (const Solver solver : kSolvers) {
    Method used(lab, solver, kExtent), fresh(lab, solver, kExtent);
    for (uint32_t frame = 0; frame < kFrames / 4; ++frame) used.decompose(extreme(frame, solver));
    used.reset();
    for (unsigned frame = 0; frame < 3; ++frame) {
      const Pixels picture = mosaic(kExtent, 1 + frame / 2);
      EXPECT_TRUE(used.decompose(picture) == fresh.decompose(picture))
          << name_of(solver) << ", frame " << frame;
    }
  }
}

TEST(Recovery, HistoryOfTheThesisMethodFades) {
  // Five keyframes, five frames apart, and a palette that takes a tenth of each frame.
  const Lab lab;
  Method used(lab, Solver::pcg, kExtent), fresh(lab, Solver::pcg, kExtent);
  for (uint32_t frame = 0; frame < kFrames / 4; ++frame) used.decompose(extreme(frame));
  const Pixels picture = frame_of(kPicture, 0);
  // Of the residual of a fresh one, what the used one's is.
  const auto ratio = [&] {
    const Pixels got = used.decompose(picture).intrinsic,
                 expected = fresh.decompose(picture).intrinsic;
    double model = 0, wanted = 0;
    for (size_t i = 0; i < got.size(); ++i) {
      EXPECT_TRUE(std::isfinite(got[i]));
      if (i % 4 == 3) continue;
      model += std::abs(static_cast<double>(got[i] * got[i | 3] - picture[i]));
      wanted += std::abs(static_cast<double>(expected[i] * expected[i | 3] - picture[i]));
    }
    return model / wanted;
  };
  const double first = ratio();
  double last = 0;
  for (int frame = 1; frame < 31; ++frame) last = ratio();  // 1.21 after 21, 1.16 after 31
  EXPECT_GT(first, 1.2) << "there was nothing to forget";
  EXPECT_LT(last, 1.2) << "the model explains the picture as well as a fresh one's does";
}

}  // namespace
}  // namespace inverse::extremes
